//! The paper's formulation: a body in a frame that travels with its rigid motion.

use std::any::Any;
use std::fmt;

use modal::ReducedBody;

use crate::account::Energies;
use crate::attitude_account::AttitudeAccount;
use crate::checkpoint::StateCoder;
use crate::error::{SetupError, StepError};
use crate::initial::Initial;
use crate::model::ModalModel;
use crate::moment::Moment;
use crate::motion::{BodyMotion, PointShapes};
use crate::observation::Observation;
use crate::scheme::Scheme;
use crate::state::{MotionState, State};
use crate::work::Work;

/// The attitude is checked after so many steps: often enough for a sum, and too seldom to cost anything.
const STEPS_OF_ATTITUDE: u64 = 8;

/// Evaluations of the rates in a step.
pub(crate) const EVALUATIONS: u32 = 4;

/// A body with its state in the travelling frame.
#[derive(Debug, Clone)]
pub struct FrameMotion {
    pub(crate) model: ModalModel,
    pub(crate) motion: BodyMotion,
    pub(crate) state: State,
    pub(crate) work: Work,
}

/// A time integration in the travelling frame, of [`EVALUATIONS`] evaluations a step.
pub trait FrameSteps: fmt::Debug + Clone + Send + Sync + 'static {
    /// Does one step of length `h` that ends at time `end`.
    ///
    /// # Errors
    /// [`StepError`]; the state stays that before the step.
    fn step(&mut self, body: &mut FrameMotion, h: f64, end: f64) -> Result<(), StepError>;

    /// Finds the accelerations, ω and α that belong to the displacements and velocities of the state. Loads follow the
    /// laws that hold at the time `inside`.
    fn complete_state(&mut self, body: &mut FrameMotion, inside: f64);

    /// A load may jump at the time of the state.
    fn pass_corner(&mut self) {}

    /// Takes over from another what it carries from step to step.
    fn copy_from(&mut self, _from: &Self) {}

    /// Encodes or decodes what it carries from step to step.
    fn code(&mut self, _coder: &mut StateCoder<'_>) {}
}

/// Steps a body of the paper's formulation.
#[derive(Debug, Clone)]
pub struct TravellingFrame<S> {
    body: FrameMotion,
    steps: S,
    steps_done: u64,
    attitude_account: AttitudeAccount,
    longest_step: f64,
}

impl<S: FrameSteps> TravellingFrame<S> {
    /// A motion of `body` from `initial`.
    pub(crate) fn begin(
        body: &ReducedBody,
        model: ModalModel,
        initial: &Initial,
        steps: S,
    ) -> Result<Self, SetupError> {
        model.check_body(body)?;
        let motion = BodyMotion::new(body)?.beginning_at(initial.attitude);
        let body = FrameMotion { model, motion, state: State::begin(body, initial)?, work: Work::default() };
        let attitude_account = AttitudeAccount::default();
        let mut frame = Self { body, steps, steps_done: 0, attitude_account, longest_step: 0.0 };
        frame.steps.complete_state(&mut frame.body, 0.0);
        Ok(frame)
    }

    /// The state that has been reached.
    pub fn state(&self) -> &State {
        &self.body.state
    }
}

impl<S: FrameSteps> Scheme for TravellingFrame<S> {
    fn time(&self) -> f64 {
        self.body.state.time
    }

    fn step(&mut self, h: f64, end: f64) -> Result<(), StepError> {
        let FrameMotion { motion, state, work, .. } = &self.body;
        if self.steps_done.is_multiple_of(STEPS_OF_ATTITUDE) {
            motion.check_attitude(state, work, &mut self.attitude_account, self.longest_step)?;
        }
        self.steps.step(&mut self.body, h, end)?;
        self.steps_done += 1;
        self.longest_step = self.longest_step.max(h);
        Ok(())
    }

    fn pass_corner(&mut self) -> Result<(), StepError> {
        self.steps.pass_corner();
        Ok(())
    }

    fn observe(&mut self, points: &[PointShapes], out: &mut Observation) -> Result<(), StepError> {
        let FrameMotion { motion, state, work, .. } = &self.body;
        motion.observe(state, work, points, out);
        Ok(())
    }

    fn state(&self) -> Result<MotionState, StepError> {
        Ok(self.body.motion.state(&self.body.state))
    }

    fn set_state(&mut self, state: &MotionState) -> Result<(), SetupError> {
        self.body.motion.set_state(state, &mut self.body.state)?;
        self.steps.complete_state(&mut self.body, state.time);
        self.steps.pass_corner();
        self.attitude_account = AttitudeAccount::default();
        Ok(())
    }

    fn copy_state(&mut self, from: &dyn Scheme) {
        let Some(from) = (from as &dyn Any).downcast_ref::<Self>() else { return };
        self.body.state.copy_from(&from.body.state);
        self.body.work = from.body.work;
        self.steps.copy_from(&from.steps);
        self.steps_done = from.steps_done;
        self.attitude_account = from.attitude_account;
        self.longest_step = from.longest_step;
    }

    fn moment(&self) -> Moment<'_> {
        let State { time, omega_body, modal_displacement, modal_velocity, .. } = &self.body.state;
        let (q, y) = (&modal_displacement[6..], &modal_velocity[6..]);
        Moment { time: *time, omega_body: *omega_body, modal_displacement: q, modal_velocity: y }
    }

    fn energies(&self) -> Option<Energies> {
        Some(self.body.motion.energies_of(&self.body.state, &self.body.work))
    }

    fn work_and_dissipation(&self) -> [f64; 2] {
        [self.body.work.work, self.body.work.dissipation]
    }

    fn fastest_rate(&self) -> f64 {
        self.body.model.fastest_rate()
    }

    fn evaluations(&self) -> u64 {
        u64::from(EVALUATIONS) * self.steps_done
    }

    fn flexible(&self) -> usize {
        self.body.state.modal_displacement.len() - 6
    }

    fn code(&mut self, coder: &mut StateCoder<'_>) {
        self.body.state.code(coder);
        self.body.work.code(coder);
        self.steps.code(coder);
        coder.count(&mut self.steps_done);
        coder.number(&mut self.longest_step);
        self.attitude_account.code(coder);
    }

    fn boxed_clone(&self) -> Box<dyn Scheme> {
        Box::new(self.clone())
    }
}
