//! Modes as an axis of their own: what keeping fewer or more of them changes.

use frames_rk4::{ConservativeScheme, Method, StepControl};
use scene::{Model, Scene};
use serde::Serialize;

use super::CostSettings;
use super::case::Case;
use super::reference::converge;
use super::run::{Errors, Timing, Trajectory};

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
    /// What the steps leave of error in these motions.
    pub step_error: f64,
    /// Time of a step of the exponential scheme, seconds.
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

/// Runs the motion with the exponential scheme and each number of modes. `richest` has the most; empty where the motion
/// with the most modes cannot be run.
pub(super) fn compare(scene: &Scene, richest: &Model, counts: &[usize], settings: &CostSettings) -> Vec<ModesRow> {
    let method = Method::Conservative(ConservativeScheme::Exponential);
    let Ok(most) = converge(&Case::new(scene, richest), method, settings.budget(5), CONVERGED) else {
        return Vec::new();
    };
    let control = StepControl::Fixed(most.step);
    let row = |count: usize| -> Option<ModesRow> {
        let model = richest.truncated(count);
        let case = Case::new(scene, &model);
        let simulation = case.begin(method, control).ok()?;
        let timing = Timing::of(&simulation, settings.timed_for).ok()?;
        let run = Trajectory::follow(simulation).ok()?;
        let is_most = count == richest.body.flexible();
        Some(ModesRow {
            flexible: count,
            highest_frequency: model.natural_frequencies().last().copied().unwrap_or_default(),
            errors: (!is_most).then(|| Errors::between(&run, &most.trajectory, case.scales())),
            step_error: most.error.largest(),
            seconds_per_step: timing.shortest.as_secs_f64() / run.stats.accepted as f64,
        })
    };
    counts.iter().filter_map(|count| row(*count)).collect()
}

/// Says that more digits than a target's need more modes, if they do.
pub(super) fn warning(rows: &[ModesRow], flexible: usize, target: f64) -> Option<String> {
    let most = rows.last()?.flexible;
    let error = |count: usize| rows.iter().find(|row| row.flexible == count)?.errors.map(|errors| errors.largest());
    let here = error(flexible).filter(|error| *error > target)?;
    let better = error(2 * flexible)
        .map_or_else(String::new, |error| format!(" (with `flexible = {}` {error:.1e})", 2 * flexible));
    Some(format!(
        "The modes are the larger error: the motion with {flexible} of them is {here:.1e} from that with \
         {most}{better}. Digits below that come from more modes, not from shorter steps."
    ))
}

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
        let words = warning(&rows, 10, 1e-6).unwrap();
        for expected in ["with 10 of them is 1.0e-3 from that with 40", "`flexible = 20` 1.0e-4"] {
            assert!(words.contains(expected), "{words}");
        }
        assert_eq!(warning(&rows, 10, 1e-2), None);
        assert_eq!(warning(&rows[..2], 10, 1e-2), None);
    }
}
