//! The last step, kept for events, rows and times within it.

use crate::body::shapes::PointShapes;
use crate::error::StepError;
use crate::motion::Motion;
use crate::motion::facts::MotionFacts;
use crate::observation::system::SystemObservation;

/// The last step: the motion at its start, and where times within it are tried.
#[derive(Debug, Clone)]
pub(crate) struct LastStep {
    pub(crate) before: Box<dyn Motion>,
    pub(crate) probe: Box<dyn Motion>,
    observation: SystemObservation,
}

/// A step that has been done, inside of which events are looked for.
pub(crate) struct Inside<'a> {
    pub step: &'a mut LastStep,
    pub points: &'a [Vec<PointShapes>],
    pub retaken: Retaken,
    /// Time at the end of the step, equal to the time of the motion there to the last bit.
    pub end: f64,
}

/// How a part of a step is taken once more.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Retaken {
    /// True in two halves, as steps in pairs are.
    pub in_halves: bool,
    /// Exactness of iterations.
    pub exactness: f64,
}

impl LastStep {
    pub(crate) fn new(motion: &dyn Motion, facts: &MotionFacts, points: &[Vec<PointShapes>]) -> Self {
        let (before, probe) = (motion.boxed_clone(), motion.boxed_clone());
        Self { before, probe, observation: SystemObservation::new(facts, points) }
    }

    /// Keeps the motion before a step, or where no step has led to.
    pub(crate) fn keep(&mut self, motion: &dyn Motion) {
        self.before.copy_state(motion);
    }

    /// Takes the probe to a time in the step as the motion at its end knows the way.
    pub(crate) fn interpolate(&mut self, after: &dyn Motion, time: f64) -> Result<(), StepError> {
        self.probe.go_within(&*self.before, after, time)
    }

    /// Takes the probe to a time in the step by a shorter step from its start, so that it is as accurate as the scheme.
    pub(crate) fn go_to(&mut self, time: f64, Retaken { in_halves, exactness }: Retaken) -> Result<(), StepError> {
        let Self { before, probe, .. } = self;
        probe.copy_state(&**before);
        let start = before.time();
        let h = time - start;
        if h <= 0.0 {
            return Ok(());
        }
        if in_halves {
            probe.part_of_step(0.5 * h, start + 0.5 * h, exactness)?;
            probe.part_of_step(0.5 * h, time, exactness)
        } else {
            probe.part_of_step(h, time, exactness)
        }
    }
}

impl Inside<'_> {
    /// Start and end of the step.
    pub(crate) fn span(&self) -> [f64; 2] {
        [self.step.before.time(), self.end]
    }

    /// The motion at a time inside the step.
    pub(crate) fn at(&mut self, time: f64) -> Result<&SystemObservation, StepError> {
        self.step.go_to(time, self.retaken)?;
        let LastStep { probe, observation, .. } = &mut *self.step;
        observation.find(&mut **probe, self.points)?;
        Ok(observation)
    }
}
