//! Observers of a run, which do not own its loop.

use crate::body::shapes::PointShapes;
use crate::error::StepError;
use crate::motion::Motion;
use crate::observation::system::SystemObservation;

/// Watches a run step by step. A closure of `&SystemObservation` is one, too.
pub trait Observer: Send {
    /// Sees the end of a step.
    ///
    /// # Errors
    /// One ends [`Simulation::advance`](crate::Simulation::advance) there.
    fn step(&mut self, now: &mut StepEnd<'_>) -> Result<(), StepError>;

    /// Sees the state whose motion [`Simulation::observe`](crate::Simulation::observe) is asked for, as at each row.
    ///
    /// # Errors
    /// One is returned from there.
    fn observed(&mut self, now: &mut StepEnd<'_>) -> Result<(), StepError> {
        let _ = now;
        Ok(())
    }
}

impl<F: FnMut(&SystemObservation) + Send> Observer for F {
    fn step(&mut self, now: &mut StepEnd<'_>) -> Result<(), StepError> {
        self(now.observation()?);
        Ok(())
    }
}

/// The end of a step, as an [`Observer`] sees it.
pub struct StepEnd<'a> {
    pub(crate) motion: &'a mut dyn Motion,
    pub(crate) points: &'a [Vec<PointShapes>],
    /// Length of the longest step so far; 0 before the first.
    pub(crate) longest_step: f64,
    pub(crate) observation: &'a mut SystemObservation,
    /// True if `observation` is that of the state.
    pub(crate) is_observed: bool,
}

impl StepEnd<'_> {
    /// The motion: quantities that it knows without another evaluation of the rates.
    pub fn motion(&self) -> &dyn Motion {
        self.motion
    }

    /// Length of the longest step so far; 0 before the first.
    pub fn longest_step(&self) -> f64 {
        self.longest_step
    }

    /// The motion of all bodies, which is found at the first call: the rates are evaluated for it.
    ///
    /// # Errors
    /// [`StepError`] where the motion cannot be observed.
    pub fn observation(&mut self) -> Result<&SystemObservation, StepError> {
        if !self.is_observed {
            self.observation.find(self.motion, self.points)?;
            self.is_observed = true;
        }
        Ok(self.observation)
    }
}
