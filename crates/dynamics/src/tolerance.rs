//! The meaning of `tolerance`, for bodies alone and in joints: it bounds the sum of the estimated errors of all steps of a run.
//!
//! A step of length h may err by tol·h/(t_end − t_0). Its error is the largest of [`ErrorKinds`]. To bound one more kind of error, add it
//! there: every step control then does.

pub(crate) mod allowance;

use serde::{Deserialize, Serialize};

use crate::simulation::checkpoint::{CheckpointError, finite};
use crate::tolerance::allowance::Allowance;

/// Errors of one step, or of all steps together, by what they are errors of.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct ErrorKinds {
    /// Place over the size of the largest body, and attitude, rad: the largest of all bodies; what neither springs nor shapes hold back, four
    /// times, since the motion carries it on. Of a body alone, all that it counts.
    pub place: f64,
    /// Deformation over its largest so far, both as root mean squares over the mass: the largest of all bodies.
    pub deformation: f64,
    /// Velocities that springs and shapes do not hold back, in the norm of the kinetic energy, over the largest speed so far.
    pub drift: f64,
    /// Energy that the step makes or loses, over twice the largest so far.
    pub energy: f64,
}

impl ErrorKinds {
    fn list(&self) -> [f64; 4] {
        let Self { place, deformation, drift, energy } = *self;
        [place, deformation, drift, energy]
    }

    fn of(list: [f64; 4]) -> Self {
        let [place, deformation, drift, energy] = list;
        Self { place, deformation, drift, energy }
    }

    /// Names of the kinds, in words.
    pub const NAMES: [&'static str; 4] = ["place and attitude", "deformation", "drift of velocities", "work of laws"];

    /// The kinds with their names.
    pub fn named(&self) -> impl Iterator<Item = (&'static str, f64)> {
        Self::NAMES.into_iter().zip(self.list())
    }

    /// The largest; a NaN stays one.
    pub fn largest(&self) -> f64 {
        self.list().into_iter().fold(0.0, |most, kind| if kind <= most { most } else { kind })
    }

    /// Errors of the order of a scheme, by errors of its embedded formula: a factor times a power of each, but not more than it.
    pub(crate) fn of_scheme(&self, [factor, power]: [f64; 2]) -> Self {
        self.with(self, |error, _| {
            let of_scheme = factor * error.powf(power);
            if of_scheme <= error { of_scheme } else { error }
        })
    }

    /// A function of the kinds of two, kind by kind.
    pub(crate) fn with(&self, other: &Self, of: impl Fn(f64, f64) -> f64) -> Self {
        let (own, other) = (self.list(), other.list());
        Self::of(std::array::from_fn(|kind| of(own[kind], other[kind])))
    }
}

/// The errors that the steps of a run state.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct StatedError {
    /// Sum over the steps of the largest kind of each: what `tolerance` bounds.
    pub sum: f64,
    /// Sums over the steps of each kind.
    pub kinds: ErrorKinds,
    /// Vibration that steps have been too long for, and so have damped, over the largest deformation so far. It is beside the sum.
    pub forgotten: f64,
}

/// Sum of errors over the tolerance below which something else than errors set the lengths of the steps.
const RULED: f64 = 0.05;

impl StatedError {
    /// The name of the kind of error that set the lengths of the steps; none where errors are far below the tolerance.
    pub fn ruling(&self, tolerance: f64) -> Option<&'static str> {
        let largest = self.kinds.named().reduce(|most, kind| if kind.1 > most.1 { kind } else { most });
        largest.filter(|(_, sum)| *sum > RULED * tolerance).map(|(name, _)| name)
    }

    /// Refuses numbers that are not finite.
    pub(crate) fn check(&self) -> Result<(), CheckpointError> {
        finite("the error of the steps", self.kinds.list().iter().chain([&self.sum, &self.forgotten]))
    }
}

/// Error of Newton's method over the error that a step may make, and the least.
const NEWTON: f64 = 0.05;
const NEWTON_ROUNDING: f64 = 2e-12;

/// Vibration that a run may forget, over its tolerance, and at most.
const FORGETTABLE: f64 = 10.0;
const LARGEST_FORGETTABLE: f64 = 1e-2;

/// The measure of the errors of the steps of one run.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub struct ErrorMeasure {
    /// Bound of the sum.
    pub(crate) tolerance: f64,
    /// Time over which the steps share it.
    pub(crate) span: f64,
    /// Error of a step that is rounding.
    rounding: f64,
    allowance: Allowance,
    stated: StatedError,
    /// True if the last try was not taken.
    pub(crate) is_refused: bool,
}

impl ErrorMeasure {
    /// Bounds the sum by `tolerance` in a run of this `span`, whose steps err by `rounding` at least.
    pub(crate) fn new(tolerance: f64, span: f64, rounding: f64) -> Self {
        Self {
            tolerance,
            span,
            rounding,
            allowance: Allowance::default(),
            stated: StatedError::default(),
            is_refused: false,
        }
    }

    /// Error that is allowed to a step of length `h`.
    pub fn allowed(&self, h: f64) -> f64 {
        self.allowance.of_step(self.tolerance, h / self.span, self.rounding)
    }

    /// Error that Newton's method may leave in such a step.
    pub(crate) fn exactness(&self, h: f64) -> f64 {
        (NEWTON * self.allowed(h)).max(NEWTON_ROUNDING)
    }

    /// Vibration that steps may still forget, over the largest deformation: what they do not resolve and damp.
    pub(crate) fn forgettable(&self) -> f64 {
        (FORGETTABLE * self.tolerance).min(LARGEST_FORGETTABLE).max(self.tolerance) - self.stated.forgotten
    }

    /// A step to `end` was taken, which has forgotten some vibration beside its errors.
    pub fn taken(&mut self, end: f64, errors: &ErrorKinds, forgotten: f64) {
        self.is_refused = false;
        self.stated.forgotten += forgotten;
        self.allowance.accept(end);
        self.stated.sum += errors.largest();
        self.stated.kinds = self.stated.kinds.with(errors, |sum, error| sum + error);
    }

    /// A step from `start` to `end` was not taken.
    pub fn refused(&mut self, start: f64, end: f64) {
        self.is_refused = true;
        self.allowance.reject(start, end);
    }

    /// The error of the steps so far.
    pub fn stated(&self) -> StatedError {
        self.stated
    }

    /// Refuses a measure of another run, and numbers that no run comes to.
    pub(crate) fn check_saved(&self, saved: &Self) -> Result<(), CheckpointError> {
        crate::simulation::checkpoint::expect(
            "the tolerance",
            (self.tolerance, self.span, self.rounding) == (saved.tolerance, saved.span, saved.rounding),
        )?;
        saved.allowance.check()?;
        saved.stated.check()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_kind_that_rules_the_steps_is_the_largest_unless_all_are_small() {
        let mut measure = ErrorMeasure::new(1e-3, 1.0, f64::EPSILON);
        for (end, errors) in [
            (0.5, ErrorKinds { place: 2e-4, deformation: 1e-4, ..ErrorKinds::default() }),
            (1.0, ErrorKinds { deformation: 3e-4, energy: 1e-5, ..ErrorKinds::default() }),
        ] {
            measure.taken(end, &errors, 0.0);
        }
        let stated = measure.stated();
        assert_eq!([1e-3, 1.0].map(|tolerance| stated.ruling(tolerance)), [Some("deformation"), None]);
        assert_eq!(stated.sum, 5e-4);
    }
}
