//! The last step of a body alone, kept for events and times between steps.

use crate::body::shapes::PointShapes;
use crate::error::StepError;
use crate::motion::Motion;
use crate::observation::Observation;
use crate::simulation::events::Inside;

/// The last step: where it began, and how it was taken.
#[derive(Debug, Clone)]
pub(crate) struct LastStep {
    /// The scheme at the start of the step.
    before: Box<dyn Motion>,
    /// Where times inside the step are tried.
    probe: Box<dyn Motion>,
    observation: Observation,
    /// Time at its end, to the last bit that of the scheme there.
    end: f64,
    /// True if it was taken in two halves, as under step control.
    halved: bool,
}

impl LastStep {
    pub(crate) fn new(motion: &dyn Motion, points: usize) -> Self {
        let observation = Observation::new(motion.flexible(), points);
        let (before, probe) = (motion.boxed_clone(), motion.boxed_clone());
        Self { before, probe, observation, end: motion.time(), halved: false }
    }

    /// Keeps the state before a step that ends at a time.
    pub(crate) fn begin(&mut self, motion: &dyn Motion, end: f64, halved: bool) {
        self.before.copy_state(motion);
        self.end = end;
        self.halved = halved;
    }

    /// Start and end of the step.
    pub(crate) fn span(&self) -> [f64; 2] {
        [self.before.time(), self.end]
    }

    /// The motion at a time inside the step: by a shorter step from its start, so that it is as accurate as the scheme.
    pub(crate) fn at(&mut self, time: f64, points: &[PointShapes]) -> Result<&Observation, StepError> {
        let Self { before, probe, observation, halved, .. } = self;
        probe.copy_state(&**before);
        let start = before.time();
        let h = time - start;
        if h > 0.0 {
            if *halved {
                probe.step(0.5 * h, start + 0.5 * h)?;
                probe.step(0.5 * h, time)?;
            } else {
                probe.step(h, time)?;
            }
        }
        probe.observe(points, observation)?;
        Ok(observation)
    }

    /// The step as events look at it, with the motion of points.
    pub(crate) fn with_points<'a>(&'a mut self, points: &'a [PointShapes]) -> StepWithPoints<'a> {
        StepWithPoints { step: self, points }
    }

    /// The scheme at the time that was looked at last.
    pub(crate) fn probe(&self) -> &dyn Motion {
        &*self.probe
    }
}

/// A step with the points that are observed.
pub(crate) struct StepWithPoints<'a> {
    step: &'a mut LastStep,
    points: &'a [PointShapes],
}

impl Inside<Observation> for StepWithPoints<'_> {
    fn span(&self) -> [f64; 2] {
        self.step.span()
    }

    fn at(&mut self, time: f64) -> Result<&Observation, StepError> {
        self.step.at(time, self.points)
    }
}
