//! The last step of a system, kept for rows, events and times within it.

use crate::body::shapes::PointShapes;
use crate::error::StepError;
use crate::simulation::events::Inside;
use crate::system::radau::{Failed, SystemMotion};
use crate::system::simulation::observation::SystemObservation;

/// Exactness of Newton's method in steps whose error nobody bounds.
pub(super) const EXACT: f64 = 1e-10;

/// A step that has been done.
#[derive(Debug, Clone)]
pub(super) struct LastStep {
    /// The motion at its start.
    pub before: SystemMotion,
    /// Time at its end, to the last bit that of the motion there.
    pub end: f64,
    /// The motion at times within it.
    pub probe: SystemMotion,
    /// The motion that events see there.
    observation: SystemObservation,
}

impl LastStep {
    pub fn new(motion: &SystemMotion, points: &[Vec<PointShapes>]) -> Self {
        let (before, probe) = (motion.clone(), motion.clone());
        Self { before, probe, end: motion.time(), observation: SystemObservation::new(motion.system(), points) }
    }

    /// Keeps the motion before a step.
    pub fn begin(&mut self, motion: &SystemMotion) {
        self.before.copy_from(motion);
    }

    /// Takes a motion for the start and the end of a step.
    pub fn keep(&mut self, motion: &SystemMotion) {
        self.before.copy_from(motion);
        self.end = motion.time();
    }

    /// Takes the probe to a time in the step, by its polynomials; `motion` has done the step.
    pub fn interpolate(&mut self, motion: &SystemMotion, time: f64) -> Result<(), StepError> {
        let Self { before, probe, end, .. } = self;
        probe
            .go_within(before, (motion, *end), time)
            .map_err(|failed| of_step(failed, before.time(), *end - before.time()))
    }

    /// Takes the probe to a time in the step by a step that ends there, so that it is as accurate as the scheme.
    pub fn go_to(&mut self, time: f64, exactness: f64) -> Result<(), StepError> {
        let Self { before, probe, .. } = self;
        probe.copy_from(before);
        let h = time - before.time();
        if h > 0.0 {
            probe.try_step(h, time, exactness, f64::INFINITY).map_err(|failed| of_step(failed, before.time(), h))?;
        }
        Ok(())
    }

    /// The step as events look at it.
    pub fn with_points<'a>(&'a mut self, points: &'a [Vec<PointShapes>], exactness: f64) -> StepWithPoints<'a> {
        StepWithPoints { step: self, points, exactness }
    }
}

/// The error of a step that was not done.
pub(super) fn of_step(failed: Failed, time: f64, step: f64) -> StepError {
    match failed {
        Failed::Newton => StepError::Newton { time, step },
        Failed::Rates(error) => error.in_step(time, step),
        Failed::Open { joints, gap } => StepError::Open { time: time + step, joints, gap },
    }
}

/// A step with the points that are observed.
pub(super) struct StepWithPoints<'a> {
    step: &'a mut LastStep,
    points: &'a [Vec<PointShapes>],
    exactness: f64,
}

impl Inside<SystemObservation> for StepWithPoints<'_> {
    fn span(&self) -> [f64; 2] {
        [self.step.before.time(), self.step.end]
    }

    fn at(&mut self, time: f64) -> Result<&SystemObservation, StepError> {
        self.step.go_to(time, self.exactness)?;
        let LastStep { probe, observation, before, .. } = &mut *self.step;
        observation.fill(probe, self.points).map_err(|error| error.in_step(time, time - before.time()))?;
        Ok(observation)
    }
}
