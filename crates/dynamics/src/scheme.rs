//! Schemes: how one step goes through equations.

pub(crate) mod abilities;
pub(crate) mod exponential;
pub(crate) mod mode_limit;
pub(crate) mod phi;
pub(crate) mod runge_kutta;

use std::fmt;

use crate::equations::Equations;
use crate::error::StepError;
use crate::state::State;

/// A time integration of equations, one step at a time.
///
/// ```
/// use dynamics::{Equations, Evaluation, Scheme, Step, StepError};
///
/// /// The explicit midpoint rule; the room is made by `equations.evaluation()`.
/// #[derive(Debug, Clone)]
/// struct Midpoint<E: Equations>(E::Evaluation);
///
/// impl<E: Equations> Scheme<E> for Midpoint<E> {
///     const ORDER: u32 = 2;
///
///     fn step(&mut self, step: &mut Step<'_, E>, next: &mut [f64]) -> Result<(), StepError> {
///         let h = step.length;
///         step.add_to(0.5 * h, step.first.rates(), self.0.place_mut());
///         step.evaluate(step.from.time + 0.5 * h, &mut self.0)?;
///         step.add_to(h, self.0.rates(), next);
///         Ok(())
///     }
/// }
/// ```
pub trait Scheme<E: Equations>: fmt::Debug + Clone + Send + Sync + 'static {
    /// Order of convergence.
    const ORDER: u32;

    /// True if it integrates the linear part of the equations exactly: rates then come to it without that part.
    const LINEAR_PART_IS_EXACT: bool = false;

    /// Finds the list at the end of a step; attitudes stay as they are, their rotation vectors turn them afterwards.
    ///
    /// # Errors
    /// [`StepError`], as from [`Step::evaluate`].
    fn step(&mut self, step: &mut Step<'_, E>, next: &mut [f64]) -> Result<(), StepError>;
}

/// A step that a scheme is to do.
#[derive(Debug)]
pub struct Step<'a, E: Equations> {
    /// The equations.
    pub equations: &'a E,
    /// The state at its start.
    pub from: &'a State,
    /// The rates there.
    pub first: &'a E::Evaluation,
    /// Its length h.
    pub length: f64,
    pub(crate) frame: E::Frame,
    pub(crate) linear_part: bool,
    pub(crate) evaluations: &'a mut u64,
}

impl<E: Equations> Step<'_, E> {
    /// Finds the rates at the place of `e` and a time in the step.
    ///
    /// # Errors
    /// [`StepError`] where there are none.
    pub fn evaluate(&mut self, time: f64, e: &mut E::Evaluation) -> Result<(), StepError> {
        *self.evaluations += 1;
        // Laws with branches keep those of the middle of the step.
        let times = [time, self.from.time + 0.5 * self.length];
        let refuse = |error: crate::RateError| error.in_step(self.from.time, self.length);
        self.equations.rates(times, &self.frame, e).map_err(refuse)?;
        if self.linear_part {
            self.equations.add_linear(e);
        }
        Ok(())
    }

    /// out = from + factor · rates
    pub fn add_to(&self, factor: f64, rates: &[f64], out: &mut [f64]) {
        for ((out, from), rate) in out.iter_mut().zip(&self.from.values).zip(rates) {
            *out = from + factor * rate;
        }
    }
}
