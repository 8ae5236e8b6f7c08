//! The error of the steps, from their bound or their estimate and from the balance of energy.

use scene::{Body, StepControl};

use super::card::{Line, Place, SMALL, percent};
use crate::commands::run::body_report::BodyRunReport;

/// The line of a body.
pub(super) fn line(body: &Body, report: &BodyRunReport, scene_file: &str) -> Line {
    let measured = format!("`flexframe cost {scene_file}` measures it");
    let expected = match (body.time.control, report.step_error) {
        // Jumps that nothing tells may take more.
        (StepControl::Tolerance(tolerance), Some(sum)) if sum > tolerance => {
            Some((sum, "the estimates of all steps together, more than `tolerance`"))
        }
        (StepControl::Tolerance(tolerance), _) => Some((tolerance, "bounded by `tolerance`")),
        // The estimate is that of the body alone.
        (StepControl::Fixed(_), error) if !body.tied => {
            error.map(|error| (error, "estimated from steps several times shorter"))
        }
        (StepControl::Fixed(_), _) => None,
    };
    let open = report.energy_tells.then_some(report.balances.energy);
    let shorter = match body.time.control {
        StepControl::Tolerance(_) => "a smaller `tolerance`",
        StepControl::Fixed(_) => "a shorter `step`, or `tolerance` in its place",
    };
    let next = |error: f64| if error < SMALL { String::new() } else { format!("{shorter}; {measured}") };
    let forgotten = report.forgotten_vibration;
    let mut beside = String::new();
    if forgotten > 0.0 {
        beside = format!(
            "; vibration of {} of the largest deformation was damped, which the steps do not resolve",
            percent(forgotten)
        );
    }
    if body.tied {
        beside += "; velocities and accelerations may be off by more";
    }
    let closed = open.map_or_else(String::new, |open| format!("; the energy is closed to {open:.1e}"));
    match (expected, open) {
        (Some((error, how)), open) if open.is_none_or(|open| open <= error) => {
            let most = if matches!(body.time.control, StepControl::Tolerance(_)) { "at most " } else { "about " };
            let of_what =
                if body.tied { "the size of the bodies and of the largest deformation" } else { "its largest" };
            let meaning = format!("motion off by {most}{} of {of_what}", percent(error));
            Place::Steps.known(error, meaning, format!("{how}{beside}{closed}"), next(error))
        }
        (_, Some(open)) => {
            let meaning = format!("energy off by {} of what there was or came and went", percent(open));
            let known = match expected {
                Some((error, how)) => format!("measured by its balance, though {how} to {}{beside}", percent(error)),
                None => "measured by its balance alone".to_owned(),
            };
            Place::Steps.known(open, meaning, known, if expected.is_none() { measured } else { next(open) })
        }
        // The first arm takes an error without a balance.
        (_, None) => Place::Steps.not_known("fixed steps that nothing was compared with", measured),
    }
}
