//! The error of the steps, from their bound or their estimate and from the balance of energy.

use model::Model;
use results::Results;
use scene::{Scene, StepControl};

use super::card::{Line, Place, SMALL, percent};
use crate::commands::run::body_report::BodyRunReport;

/// A bound over the largest deformation above which it is told that it is none of deformation and stress.
const COARSE: f64 = 1e-2;

/// The line of a body. `deformation`: the largest of the body that bends the least, over its size, with its name.
pub(super) fn line(scene: &Scene, report: &BodyRunReport, deformation: Option<(f64, &str)>, scene_file: &str) -> Line {
    let measured = format!("`flexframe cost {scene_file}` measures it");
    let expected = match scene.time.control {
        StepControl::Tolerance(tolerance) => Some((tolerance, "bounded by `tolerance`")),
        // The estimate is that of the body alone.
        StepControl::Fixed(_) if !scene.tied => {
            report.step_error.map(|error| (error, "estimated from steps several times shorter"))
        }
        StepControl::Fixed(_) => None,
    };
    let open = report.energy_tells.then_some(report.balances.energy);
    let shorter = match scene.time.control {
        StepControl::Tolerance(_) => "a smaller `tolerance`",
        StepControl::Fixed(_) => "a shorter `step`, or `tolerance` in its place",
    };
    // The bound of a body in joints is over its size, which says little of one that hardly bends.
    let coarse = deformation.filter(|(size, _)| scene.tied && expected.is_some_and(|(error, _)| error > COARSE * size));
    let is_small = |error: f64| error < SMALL && coarse.is_none();
    let next = |error: f64| if is_small(error) { String::new() } else { format!("{shorter}; {measured}") };
    let beside = match coarse {
        Some((deformation, body)) => format!(
            "; velocities, accelerations, deformation and stress may be off by more: the largest deformation of {body} is {} of its size",
            percent(deformation)
        ),
        None if scene.tied => "; velocities and accelerations may be off by more".to_owned(),
        None => String::new(),
    };
    let closed = open.map_or_else(String::new, |open| format!("; the energy is closed to {open:.1e}"));
    match (expected, open) {
        (Some((error, how)), open) if open.is_none_or(|open| open <= error) => {
            let most = if matches!(scene.time.control, StepControl::Tolerance(_)) { "at most " } else { "about " };
            let of_what = if scene.tied { "the size of the bodies and of the largest deformation" } else { "its largest" };
            let meaning = format!("motion off by {most}{} of {of_what}", percent(error));
            Place::Steps.known(error, meaning, format!("{how}{beside}{closed}"), next(error))
        }
        (_, Some(open)) => {
            let meaning = format!("energy off by {} of what there was or came and went", percent(open));
            let known = match expected {
                Some((error, how)) => {
                    let beside = if coarse.is_some() { &beside } else { "" };
                    format!("measured by its balance, though {how} to {}{beside}", percent(error))
                }
                None => "measured by its balance alone".to_owned(),
            };
            Place::Steps.known(open, meaning, known, if expected.is_none() { measured } else { next(open) })
        }
        // The first arm takes an error without a balance.
        (_, None) => Place::Steps.not_known("fixed steps that nothing was compared with", measured),
    }
}

/// The largest deformation of a body in a row over its size, both as root mean squares over its mass; `None` of one that does not bend.
pub(super) fn largest_deformation(model: &Model, results: &Results, body: usize) -> Option<f64> {
    let rows = results.bodies().nth(body)?.table("modal/displacement")?;
    let squares = (0..rows.rows()).filter_map(|row| rows.row(row)).map(|q| q.iter().map(|x| x * x).sum::<f64>());
    let largest = squares.fold(0.0, f64::max);
    (largest > 0.0).then(|| (largest / (0.5 * model.body.inertia.trace())).sqrt())
}
