//! The bounds of a step, and what its estimated errors make of them.

use crate::matrix::lists::larger;
use crate::tolerance::{ErrorKinds, ErrorMeasure};

/// A step may forget this part of what the run may still forget, and one of the first steps this one.
const FORGET_STEP: f64 = 8.0;
const FORGET_FIRST: f64 = 16.0;

/// Error of Newton's method over the tolerance, and the least, that is enough where rounding keeps it from more.
const ENOUGH: f64 = 1e-3;
const LEAST_ENOUGH: f64 = 1e-9;
/// Energy that a step may make or lose over the tolerance, however short it is: where laws have kinks, shorter steps do not make less.
const LEAST_ENERGY: f64 = 1e-3;

/// The estimated errors of a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Estimate {
    pub errors: ErrorKinds,
    /// Amplitude of the vibration that rules the error of deformation, over the largest deformation; none of the first steps.
    pub amplitude: Option<f64>,
    /// True if the largest is one of the order of the scheme.
    pub has_order_of_scheme: bool,
}

/// Bounds of a step.
#[derive(Debug, Clone, Copy)]
pub(in crate::system) struct Bound {
    /// Error that Newton's method may leave.
    pub exactness: f64,
    /// The same where rounding keeps it from that.
    pub enough: f64,
    /// Largest error of the step.
    pub allowed: f64,
    /// Length of the run, by which drifts are measured.
    pub span: f64,
    /// Vibration that may still be forgotten, over the largest deformation.
    pub forgettable: f64,
    /// Largest error of the energy.
    pub allowed_energy: f64,
}

impl Bound {
    /// Bounds of a step that is no part of a run.
    pub fn of_one_step(exactness: f64, allowed: f64) -> Self {
        let span = f64::INFINITY;
        Self { exactness, enough: 0.0, allowed, span, forgettable: 0.0, allowed_energy: allowed }
    }

    /// Bounds of a step of length `h` in a run.
    pub fn of(measure: &ErrorMeasure, h: f64) -> Self {
        let allowed = measure.allowed(h);
        Self {
            exactness: measure.exactness(h),
            enough: (ENOUGH * measure.tolerance).max(LEAST_ENOUGH),
            allowed,
            span: measure.span,
            forgettable: measure.forgettable(),
            allowed_energy: allowed.max(LEAST_ENERGY * measure.tolerance),
        }
    }

    /// Largest of errors over what is allowed; a NaN stays one.
    pub fn ratio(&self, errors: &ErrorKinds) -> f64 {
        larger(ErrorKinds { energy: 0.0, ..*errors }.largest() / self.allowed, errors.energy / self.allowed_energy)
    }
}

impl Estimate {
    /// Deformation that the step forgets beyond the error that is allowed to it, where it may. The error is then the one that is allowed.
    pub fn forget(&mut self, bound: &Bound) -> f64 {
        let Bound { allowed, forgettable, .. } = *bound;
        let deformation = self.errors.deformation;
        let others = bound.ratio(&ErrorKinds { deformation: 0.0, ..self.errors });
        let may = match self.amplitude {
            Some(amplitude) => amplitude <= forgettable && deformation <= forgettable / FORGET_STEP,
            None => deformation <= forgettable / FORGET_FIRST,
        };
        if deformation > allowed && others <= 1.0 && may {
            self.errors.deformation = allowed;
            return deformation - allowed;
        }
        0.0
    }
}
