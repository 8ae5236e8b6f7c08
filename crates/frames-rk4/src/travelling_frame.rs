//! The paper's formulation: a body in a frame that travels with its rigid motion.

use std::any::Any;
use std::fmt;

use dynamics::checkpoint::{CheckpointError, counts, decode, encode, finite};
use dynamics::reduced_body::ReducedBody;
use dynamics::rigid_kin::BeyondFullTurn;
use dynamics::{
    Energies, Initial, Moment, Motion, MotionFacts, MotionState, Observation, PointShapes, SetupError, StepError, Work,
};
use serde::{Deserialize, Serialize};

use crate::attitude_account::AttitudeAccount;
use crate::body_motion::BodyMotion;
use crate::model::ModalModel;
use crate::state::State;

/// The name of the formulation.
pub(crate) const FORMULATION: &str = "paper";

/// Number of steps after which the attitude is checked: often enough for a sum, and too seldom to cost anything.
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
    /// branches of their histories that hold at `branch_time`.
    fn complete_state(&mut self, body: &mut FrameMotion, branch_time: f64);

    /// A load may jump at the time of the state.
    fn pass_discontinuity(&mut self) {}

    /// Quantities that it carries from step to step.
    fn carried(&self) -> Carried {
        Carried::default()
    }

    /// Goes on with what another has carried.
    fn carry_on(&mut self, _carried: Carried) {}
}

/// Quantities that steps may carry from one to the next.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub struct Carried {
    /// Power of the loads at the state.
    pub(crate) power: Work,
    /// True if a load may jump at the state.
    pub(crate) at_discontinuity: bool,
}

/// State in a checkpoint.
#[derive(Serialize, Deserialize)]
struct Saved {
    state: State,
    work: Work,
    carried: Carried,
    #[serde(with = "dynamics::checkpoint::fixed_room")]
    steps_done: u64,
    longest_step: f64,
    attitude_account: AttitudeAccount,
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
        let motion = BodyMotion::new(body)?.beginning_at(initial);
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

impl<S: FrameSteps> Motion for TravellingFrame<S> {
    fn facts(&self) -> MotionFacts {
        let FrameMotion { model, state, .. } = &self.body;
        MotionFacts::of_body(state.modal_displacement.len() - 6, model.fastest_rate())
    }

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

    fn pass_discontinuity(&mut self) -> Result<(), StepError> {
        self.steps.pass_discontinuity();
        Ok(())
    }

    fn loads_have_changed(&mut self) {
        self.steps.pass_discontinuity();
    }

    fn observe(&mut self, _: usize, points: &[PointShapes], out: &mut Observation) -> Result<(), StepError> {
        let FrameMotion { motion, state, work, .. } = &self.body;
        motion.observe(state, work, points, out);
        Ok(())
    }

    fn states(&self) -> Result<Vec<MotionState>, StepError> {
        Ok(vec![self.body.motion.state(&self.body.state)])
    }

    fn set_states(&mut self, states: &[MotionState]) -> Result<(), SetupError> {
        let state = MotionState::only(states)?;
        self.body.motion.set_state(state, &mut self.body.state)?;
        self.steps.complete_state(&mut self.body, state.time);
        self.steps.pass_discontinuity();
        self.attitude_account = AttitudeAccount::default();
        Ok(())
    }

    fn copy_state(&mut self, from: &dyn Motion) {
        let Some(from) = (from as &dyn Any).downcast_ref::<Self>() else { return };
        self.body.state.copy_from(&from.body.state);
        self.body.work = from.body.work;
        self.steps.carry_on(from.steps.carried());
        self.steps_done = from.steps_done;
        self.attitude_account = from.attitude_account;
        self.longest_step = from.longest_step;
    }

    fn moment(&self, _: usize) -> Moment<'_> {
        let State { time, omega_body, modal_displacement, modal_velocity, .. } = &self.body.state;
        let (q, y) = (&modal_displacement[6..], &modal_velocity[6..]);
        Moment { time: *time, omega_body: *omega_body, modal_displacement: q, modal_velocity: y }
    }

    fn energies(&self) -> Option<Energies> {
        Some(self.body.motion.energies_of(&self.body.state, &self.body.work))
    }

    fn step_is_done(&mut self) -> [f64; 2] {
        [self.body.work.work, self.body.work.dissipation]
    }

    fn evaluations(&self) -> u64 {
        u64::from(EVALUATIONS) * self.steps_done
    }

    fn save(&self) -> Result<Vec<u8>, CheckpointError> {
        encode(&Saved {
            state: self.body.state.clone(),
            work: self.body.work,
            carried: self.steps.carried(),
            steps_done: self.steps_done,
            longest_step: self.longest_step,
            attitude_account: self.attitude_account,
        })
    }

    fn restore(&mut self, saved: &[u8]) -> Result<(), CheckpointError> {
        let Saved { state, work, carried, steps_done, longest_step, attitude_account } = decode(saved)?;
        state.check(self.body.state.modal_displacement.len())?;
        work.check()?;
        carried.power.check()?;
        counts(&[steps_done])?;
        finite("the longest step", [&longest_step])?;
        attitude_account.check_saved()?;
        (self.body.state, self.body.work) = (state, work);
        self.steps.carry_on(carried);
        (self.steps_done, self.longest_step, self.attitude_account) = (steps_done, longest_step, attitude_account);
        Ok(())
    }

    fn boxed_clone(&self) -> Box<dyn Motion> {
        Box::new(self.clone())
    }
}

/// The error of a step in which the body turns too far.
pub(crate) fn turn_error(&BeyondFullTurn { angle }: &BeyondFullTurn, time: f64, step: f64) -> StepError {
    if angle.is_finite() {
        StepError::TurnTooLarge { time, step, angle }
    } else {
        StepError::NotFinite { time, what: "the angular velocity" }
    }
}
