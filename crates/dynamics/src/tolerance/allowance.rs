//! The error that a step under step control may make.
//!
//! Each step may take its share of the tolerance, by its length, so that the estimates of all steps sum to the tolerance.
//! At a jump that no load names the error falls with the step itself and never comes below that share. A step that has
//! been shortened many times at one place may therefore take a fixed part of the tolerance.

use serde::{Deserialize, Serialize};

use crate::simulation::checkpoint::{CheckpointError, counts, finite};

/// Tries in vain at one place after which the motion is taken to jump there.
const TRIES_AT_JUMP: u64 = 6;
/// The first jumps may take this part of the tolerance each; the parts then fall, so that all together come to the
/// tolerance after about a hundred jumps and to ten times as much after a million.
const PART_OF_JUMP: f64 = 1.0 / 64.0;
/// Where a step errs by rounding, a longer one would do as well.
const ROUNDING: f64 = 32.0 * f64::EPSILON;

/// Estimated errors under step control, relative to the motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorEstimate {
    /// Error of the step that was tried.
    pub step: f64,
    /// Error to be expected of a step twice as long.
    pub doubled: f64,
}

/// Jumps met so far, and the place that is being tried.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub(crate) struct Allowance {
    /// End of the shortest try in vain at a place.
    place: f64,
    /// Tries in vain that began before it.
    #[serde(with = "postcard::fixint::le")]
    rejected: u64,
    #[serde(with = "postcard::fixint::le")]
    jumps: u64,
}

impl Allowance {
    /// The error that is allowed to a step that is this `part` of the run, where steps err by `rounding` at least.
    pub(crate) fn of_step(&self, tolerance: f64, part: f64, rounding: f64) -> f64 {
        // Where the share is below rounding, a shorter step would be no better.
        let share = (tolerance * part).max(rounding);
        if self.rejected < TRIES_AT_JUMP {
            return share;
        }
        share.max(tolerance * PART_OF_JUMP / (1.0 + PART_OF_JUMP * self.jumps as f64))
    }

    /// A step to `end` was taken.
    pub(crate) fn accept(&mut self, end: f64) {
        if end >= self.place {
            self.jumps += u64::from(self.rejected >= TRIES_AT_JUMP);
            self.rejected = 0;
        }
    }

    /// True if a step twice as long may be tried next. Twice as much is allowed to it, half of which is kept in hand.
    pub(crate) fn may_double(estimate: &ErrorEstimate, allowed: f64) -> bool {
        estimate.doubled <= allowed.max(ROUNDING)
    }

    /// A step from `start` to `end` was not taken.
    pub(crate) fn reject(&mut self, start: f64, end: f64) {
        if start >= self.place {
            (self.place, self.rejected) = (end, 0);
        }
        // Shorter tries say where the place is.
        self.place = self.place.min(end);
        self.rejected += 1;
    }

    /// Refuses numbers that no run comes to.
    pub(crate) fn check(&self) -> Result<(), CheckpointError> {
        finite("a place of a jump", [&self.place])?;
        counts(&[self.rejected, self.jumps])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_across_a_jump_may_take_a_part_of_the_tolerance_after_some_tries() {
        let (mut allowance, tolerance) = (Allowance::default(), 1e-6);
        for end in [0.8, 0.6, 0.5, 0.4, 0.35, 0.32] {
            assert_eq!(allowance.of_step(tolerance, 1e-3, f64::EPSILON), 1e-9);
            allowance.reject(0.2, end);
            // What is taken before the jump is no way across it.
            allowance.accept(0.25);
        }
        let part = allowance.of_step(tolerance, 1e-3, f64::EPSILON);
        assert_eq!(part, tolerance / 64.0);
        allowance.accept(0.8);
        assert_eq!(allowance.of_step(tolerance, 1e-3, f64::EPSILON), 1e-9);
    }
}
