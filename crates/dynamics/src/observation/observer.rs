//! Observers of a run, which do not own its loop.

use crate::body::shapes::PointShapes;
use crate::error::StepError;
use crate::motion::Motion;
use crate::observation::Observation;

/// The observation of a kind of run: that of a body, or of a [system](crate::SystemObservation).
pub trait Observed {
    /// The motion that is observed.
    type Motion: ?Sized;
    /// Points of a body, or of the bodies.
    type Points;

    /// Its time.
    fn time(&self) -> f64;

    /// Takes in the motion where it is. `longest_step` is for the error.
    ///
    /// # Errors
    /// [`StepError`] where the motion cannot be observed.
    fn find(&mut self, motion: &mut Self::Motion, points: &[Self::Points], longest_step: f64) -> Result<(), StepError>;
}

impl Observed for Observation {
    type Motion = dyn Motion;
    type Points = PointShapes;

    fn time(&self) -> f64 {
        self.time
    }

    fn find(&mut self, motion: &mut dyn Motion, points: &[PointShapes], _: f64) -> Result<(), StepError> {
        motion.observe(points, self)
    }
}

/// Watches a run step by step: of a body, or with `O` = [`SystemObservation`](crate::SystemObservation) of a system. A
/// closure of `&O` is one, too.
pub trait Observer<O: Observed = Observation>: Send {
    /// Sees the end of a step.
    ///
    /// # Errors
    /// One ends [`Simulation::advance`](crate::Simulation::advance) there.
    fn step(&mut self, now: &mut StepEnd<'_, O>) -> Result<(), StepError>;

    /// Sees the state whose motion [`Simulation::observe`](crate::Simulation::observe) is asked for, as at each row.
    ///
    /// # Errors
    /// One is returned from there.
    fn observed(&mut self, now: &mut StepEnd<'_, O>) -> Result<(), StepError> {
        let _ = now;
        Ok(())
    }
}

impl<O: Observed, F: FnMut(&O) + Send> Observer<O> for F {
    fn step(&mut self, now: &mut StepEnd<'_, O>) -> Result<(), StepError> {
        self(now.observation()?);
        Ok(())
    }
}

/// The end of a step, as an [`Observer`] sees it.
pub struct StepEnd<'a, O: Observed = Observation> {
    pub(crate) motion: &'a mut O::Motion,
    pub(crate) points: &'a [O::Points],
    /// Length of the longest step so far; 0 before the first.
    pub(crate) longest_step: f64,
    pub(crate) observation: &'a mut O,
    /// True if `observation` is that of the state.
    pub(crate) is_observed: bool,
}

impl<O: Observed> StepEnd<'_, O> {
    /// The motion: quantities that it knows without another evaluation of the rates.
    pub fn motion(&self) -> &O::Motion {
        self.motion
    }

    /// Length of the longest step so far; 0 before the first.
    pub fn longest_step(&self) -> f64 {
        self.longest_step
    }

    /// The motion, which is found at the first call: the rates are evaluated for it.
    ///
    /// # Errors
    /// [`StepError`] where the motion cannot be observed.
    pub fn observation(&mut self) -> Result<&O, StepError> {
        if !self.is_observed {
            self.observation.find(self.motion, self.points, self.longest_step)?;
            self.is_observed = true;
        }
        Ok(self.observation)
    }
}
