//! Modes as an axis of their own: what keeping fewer or more of them changes.

use dynamics::{Method, StepControl};
use model::Model;
use scene::Body;
use serde::Serialize;

use super::case::PreparedScene;
use super::reference::converge;
use super::run::{Errors, Trajectory, seconds_per_step};
use super::settings::CostSettings;
use crate::commands::run::RunFailure;
use crate::files::json;

/// Errors of the steps that do not matter here.
const CONVERGED: f64 = 1e-9;

/// The motion with a number of modes.
#[derive(Debug, Clone, Serialize)]
pub struct ModesRow {
    /// Flexible modes.
    pub flexible: usize,
    /// The highest frequency among them, cycles per time.
    pub highest_frequency: f64,
    /// Difference to the motion with the most modes; modal coordinates over the modes that both have. None for the most
    /// modes themselves.
    pub errors: Option<Errors>,
    /// Error of the steps in these motions.
    #[serde(serialize_with = "json::number")]
    pub step_error: f64,
    /// Time of a step of the exponential scheme, seconds.
    #[serde(serialize_with = "json::number")]
    pub seconds_per_step: f64,
}

/// The numbers of modes to compare: half, once, twice and four times those of the scene, as far as the mesh has them.
pub(super) fn counts(flexible: usize, most: usize) -> Vec<usize> {
    let mut counts = vec![flexible / 2, flexible, 2 * flexible, 4 * flexible];
    for count in &mut counts {
        *count = (*count).min(most.max(flexible));
    }
    counts.retain(|count| *count > 0);
    counts.dedup();
    counts
}

/// Runs the motion with the exponential scheme by models with more and more modes.
///
/// # Errors
/// The number of modes with which the motion could not be run, and why.
pub(super) fn compare(
    body: &Body,
    models: &[Model],
    settings: &CostSettings,
) -> Result<Vec<ModesRow>, (usize, RunFailure)> {
    let Some(richest) = models.last() else { return Ok(Vec::new()) };
    let method = Method::EXPONENTIAL;
    let budget = settings.budget(5);
    let most = converge(&PreparedScene::alone(body, richest), method, budget, CONVERGED)
        .map_err(|(_, failure)| (richest.body.flexible(), failure))?;
    let control = StepControl::Fixed(most.step);
    let row = |model: &Model| -> Result<ModesRow, RunFailure> {
        let case = PreparedScene::alone(body, model);
        let begun = case.begin(method, control)?;
        let seconds_per_step = seconds_per_step(&begun, settings.timed_for)?;
        let run = Trajectory::follow(begun, budget.time)?;
        let flexible = model.body.flexible();
        let is_most = flexible == richest.body.flexible();
        Ok(ModesRow {
            flexible,
            highest_frequency: model.natural_frequencies().into_iter().reduce(f64::max).unwrap_or_default(),
            errors: (!is_most).then(|| Errors::between(&run, &most.trajectory, case.scales())),
            step_error: most.error.largest(),
            seconds_per_step,
        })
    };
    models.iter().map(|model| row(model).map_err(|failure| (model.body.flexible(), failure))).collect()
}

/// Says that more digits than a target's need more modes, if they do, and in which quantity.
pub fn modes_warning(rows: &[ModesRow], flexible: usize, target: f64) -> Option<String> {
    let most = rows.last()?.flexible;
    let errors = |count: usize| rows.iter().find(|row| row.flexible == count)?.errors;
    let here = errors(flexible).filter(|errors| errors.largest() > target)?;
    let (worst, error) = here.worst();
    let beside: Vec<String> = here
        .named()
        .filter(|(name, _)| *name != worst && OF_POINTS.contains(name))
        .map(|(name, error)| format!("the {name} {error:.1e}"))
        .collect();
    let beside = if beside.is_empty() { String::new() } else { format!(", {}", beside.join(", ")) };
    let better = errors(2 * flexible).map_or_else(String::new, |errors| {
        let (worst, error) = errors.worst();
        format!(" With `flexible = {}` the {worst} is the worst, {error:.1e} off.", 2 * flexible)
    });
    Some(format!(
        "The modes are the larger error: with {flexible} of them the {worst} is {error:.1e} off from that with \
         {most}{beside}.{better} Digits below that come from more modes, not from shorter steps."
    ))
}

/// The quantities of the points that are shown beside the worst.
const OF_POINTS: [&str; 2] = ["displacement of the points", "velocity of the points"];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_modes_are_no_more_than_the_mesh_has() {
        assert_eq!(counts(10, usize::MAX), [5, 10, 20, 40]);
        assert_eq!(counts(10, 25), [5, 10, 20, 25]);
        assert_eq!(counts(10, 10), [5, 10]);
        assert_eq!(counts(1, 100), [1, 2, 4]);
        assert!(counts(0, 100).is_empty());
    }

    #[test]
    fn a_target_below_the_error_of_the_modes_is_warned_of() {
        let row = |flexible, error: Option<f64>| ModesRow {
            flexible,
            highest_frequency: 1.0,
            errors: error.map(|attitude| Errors { attitude, ..Errors::default() }),
            step_error: 1e-12,
            seconds_per_step: 1e-6,
        };
        let rows = [row(5, Some(1e-2)), row(10, Some(1e-3)), row(20, Some(1e-4)), row(40, None)];
        let words = modes_warning(&rows, 10, 1e-6).unwrap();
        for expected in [
            "with 10 of them the attitude is 1.0e-3 off from that with 40",
            "With `flexible = 20` the attitude is the worst, 1.0e-4 off",
        ] {
            assert!(words.contains(expected), "{words}");
        }
        assert_eq!(modes_warning(&rows, 10, 1e-2), None);
        assert_eq!(modes_warning(&rows[..2], 10, 1e-2), None);
    }

    #[test]
    fn the_worst_quantity_is_named_with_displacement_and_velocity_beside_it() {
        let errors = Errors {
            attitude: 2e-6,
            modal: Some(1e-4),
            displacement: Some(3e-5),
            velocity: Some(4e-2),
            acceleration: Some(0.8),
        };
        let row = |flexible, errors| ModesRow {
            flexible,
            highest_frequency: 1.0,
            errors,
            step_error: 1e-12,
            seconds_per_step: 1e-6,
        };
        let words = modes_warning(&[row(6, Some(errors)), row(24, None)], 6, 0.0).unwrap();
        let expected = "with 6 of them the acceleration of the points is 8.0e-1 off from that with 24, the displacement of \
                        the points 3.0e-5, the velocity of the points 4.0e-2.";
        assert!(words.contains(expected), "{words}");
    }
}
