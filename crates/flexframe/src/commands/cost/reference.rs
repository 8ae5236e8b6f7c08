//! The reference: a run so fine that a finer one says the same.

use std::time::{Duration, Instant};

use dynamics::{Method, StepControl};
use serde::Serialize;

use super::case::PreparedScene;
use super::run::{Errors, Trajectory};
use crate::commands::run::RunFailure;

/// Steps of the first run.
const FIRST: u64 = 100;
/// Errors above this still come from the steps, even where they do not fall; below, from rounding.
pub(super) const ROUNDING: f64 = 1e-8;

/// A run and how far it is from the limit of short steps.
pub(super) struct Reference {
    pub trajectory: Trajectory,
    pub step: f64,
    pub steps: u64,
    /// Estimate of its own error.
    pub error: Errors,
}

/// The reference of the errors.
#[derive(Debug, Clone, Serialize)]
pub struct ReferenceReport {
    /// Length of a step.
    pub step: f64,
    /// Steps.
    pub steps: u64,
    /// Estimate of its own error.
    pub own_error: Errors,
    /// Its error against another reference.
    pub errors: Option<Errors>,
}

/// Limit of the time of a reference.
#[derive(Debug, Clone, Copy)]
pub(super) struct Budget {
    /// For all runs together.
    pub time: Duration,
    /// For one run.
    pub steps: u64,
}

/// Runs a method of fourth or higher order with ever shorter steps, each half as long as those before, until the error is below
/// `goal`, or rounding hides what halving changes, or the next run would go beyond the `budget`, which also stops a run. Of two runs that are d
/// apart, the finer is d/15 from the limit, if d has fallen as it does for fourth order; else d is taken.
///
/// # Errors
/// Steps of a try and its failure, where none came to its end: the last one, but for one that ran out of time.
pub(super) fn converge(
    case: &PreparedScene<'_>,
    method: Method,
    budget: Budget,
    goal: f64,
) -> Result<Reference, (u64, RunFailure)> {
    let started = Instant::now();
    let left = || budget.time.saturating_sub(started.elapsed());
    let (mut steps, mut before) = (FIRST, None);
    let coarse = loop {
        match follow(case, method, steps, left()) {
            Ok(run) => break run,
            // What longer steps have failed for says more than that there is no time for shorter ones.
            Err(failure @ RunFailure::OutOfPatience { .. }) => return Err(before.unwrap_or((steps, failure))),
            Err(failure) if started.elapsed() > budget.time || 2 * steps > budget.steps => {
                return Err((steps, failure));
            }
            Err(failure) => {
                before = Some((steps, failure));
                steps *= 2;
            }
        }
    };
    let reference = |trajectory, steps, error| Reference { trajectory, step: case.end() / steps as f64, steps, error };
    // Without a second run nothing is known of the error.
    steps *= 2;
    let finer = follow(case, method, steps, left()).map_err(|failure| (steps, failure))?;
    let mut difference = Errors::between(&coarse, &finer, case.scales());
    let mut best = reference(finer, steps, difference);
    while best.error.largest() > goal
        && 2 * steps <= budget.steps
        && started.elapsed() + 2 * best.trajectory.time <= budget.time
    {
        steps *= 2;
        let Ok(finer) = follow(case, method, steps, left()) else { break };
        let before = difference.largest();
        difference = Errors::between(&best.trajectory, &finer, case.scales());
        let now = difference.largest();
        if now < ROUNDING && now > before / 2.0 {
            break;
        }
        let factor = if now < before / 8.0 { 1.0 / 15.0 } else { 1.0 };
        best = reference(finer, steps, difference.scaled(factor));
    }
    Ok(best)
}

fn follow(case: &PreparedScene<'_>, method: Method, steps: u64, patience: Duration) -> Result<Trajectory, RunFailure> {
    let run = case.begin(method, StepControl::Fixed(case.end() / steps as f64))?;
    Trajectory::follow(run, patience)
}
