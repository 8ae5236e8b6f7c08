//! Equations and a scheme, stepped: with fixed steps, or by pairs of steps whose error is estimated.

use std::any::Any;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::body::motion_state::MotionState;
use crate::body::shapes::PointShapes;
use crate::equations::sizes::Sizes;
use crate::equations::{Equations, ErrorNorm, Evaluation, Glance, PlainNorm, StepDone};
use crate::error::{RateError, SetupError, StepError};
use crate::motion::Motion;
use crate::motion::facts::MotionFacts;
use crate::observation::Observation;
use crate::observation::energies::Energies;
use crate::observation::moment::Moment;
use crate::scheme::{Scheme, Step};
use crate::simulation::checkpoint::{CheckpointError, counts, decode, encode, equal_room, expect, finite};
use crate::state::State;
use crate::tolerance::allowance::ErrorEstimate;

/// A state on its way through equations by a scheme.
#[derive(Debug, Clone)]
pub(crate) struct Stepper<E: Equations, S> {
    equations: E,
    scheme: S,
    state: State,
    next: State,
    /// Under step control, the state before the steps that are tried, and their end by one long step.
    before: State,
    coarse: State,
    /// The rates at the start of a step.
    first: E::Evaluation,
    /// Under step control, the rates at `next`.
    ahead: E::Evaluation,
    /// True if `first` is at `state`.
    first_known: bool,
    /// Where it is so or a row has made it so, and with all that was found on the way to the rates, the branch time.
    branch_of_first: Option<f64>,
    evaluations: u64,
    /// Under step control, the largest sizes so far, not less than those that the loads are to cause.
    largest: Sizes,
    norm: Arc<dyn ErrorNorm<E>>,
    /// Energies at the start of the last step; none of a driven body, whose drive may jump.
    energies: Option<Energies>,
}

/// Numbers of a checkpoint.
#[derive(Serialize, Deserialize)]
struct Saved {
    state: State,
    #[serde(with = "equal_room")]
    energies: Option<Energies>,
    first_known: bool,
    /// Rates of `first`.
    rates: Vec<f64>,
    #[serde(with = "postcard::fixint::le")]
    evaluations: u64,
    largest: Sizes,
}

impl<E: Equations, S: Scheme<E>> Motion for Stepper<E, S> {
    fn facts(&self) -> MotionFacts {
        MotionFacts::of_body(self.equations.flexible(), self.equations.fastest_rate())
    }

    fn time(&self) -> f64 {
        self.state.time
    }

    fn step(&mut self, h: f64, end: f64) -> Result<(), StepError> {
        self.attempt(h, end)?;
        std::mem::swap(&mut self.state, &mut self.next);
        self.forget_first();
        Ok(())
    }

    fn controlled_step(&mut self, h: f64, end: f64, tolerance: f64) -> Result<ErrorEstimate, StepError> {
        self.controlled_steps(0.5 * h, end, tolerance)
    }

    /// The rates at the end of the last step are not those of the next one's beginning.
    fn pass_discontinuity(&mut self) -> Result<(), StepError> {
        self.forget_first();
        let Self { equations, state, ahead, .. } = self;
        let time = state.time;
        equations.pass_discontinuity(state, ahead).map_err(|error| error.in_step(time, 0.0))
    }

    fn loads_have_changed(&mut self) {
        self.forget_first();
    }

    fn raise_energy_of_loads(&mut self, end: f64) -> f64 {
        let sizes = self.equations.sizes_of_loads(end);
        self.largest = self.largest.max(sizes);
        sizes.energy
    }

    fn observe(&mut self, _: usize, points: &[PointShapes], out: &mut Observation) -> Result<(), StepError> {
        let in_first = self.evaluate_for_row().map_err(|error| error.in_step(self.state.time, 0.0))?;
        let Self { equations, state, first, ahead, .. } = self;
        let e = if in_first { first } else { ahead };
        equations.observe(state, e, points, out).map_err(|error| error.in_step(state.time, 0.0))?;
        self.energies = equations.energies(state.time, e);
        Ok(())
    }

    fn states(&self) -> Result<Vec<MotionState>, StepError> {
        let state = self.equations.motion_state(&self.state);
        Ok(vec![state.map_err(|error| error.in_step(self.state.time, 0.0))?])
    }

    fn set_states(&mut self, states: &[MotionState]) -> Result<(), SetupError> {
        let to = MotionState::only(states)?;
        let set = self.equations.state_of(to)?;
        self.equations.layout().check(&set)?;
        self.state.copy_from(&set);
        self.forget_first();
        self.energies = None;
        Ok(())
    }

    fn copy_state(&mut self, from: &dyn Motion) {
        let Some(from) = (from as &dyn Any).downcast_ref::<Self>() else { return };
        self.state.copy_from(&from.state);
        self.forget_first();
        self.evaluations = from.evaluations;
        self.largest = from.largest;
        self.energies = from.energies;
    }

    /// At the start of the last step, as its first stage found them; none of a driven body, whose drive may jump.
    fn energies(&self) -> Option<Energies> {
        self.energies
    }

    /// Where the rates were last found: at the state under step control or after a row, else at the start of the last step.
    fn moment(&self, _: usize) -> Moment<'_> {
        let Glance { omega_body, modal_displacement, modal_velocity } = self.equations.glance(&self.first);
        // The states have changed places at the end of the step.
        let is_here = self.first_known || self.branch_of_first.is_some();
        let time = if is_here { self.state.time } else { self.next.time };
        Moment { time, omega_body, modal_displacement, modal_velocity }
    }

    fn step_is_done(&mut self) -> [f64; 2] {
        self.equations.work_and_dissipation(&self.state)
    }

    fn evaluations(&self) -> u64 {
        self.evaluations
    }

    fn save(&self) -> Result<Vec<u8>, CheckpointError> {
        encode(&Saved {
            state: self.state.clone(),
            energies: self.energies,
            first_known: self.first_known,
            rates: self.first.rates().to_vec(),
            evaluations: self.evaluations,
            largest: self.largest,
        })
    }

    fn restore(&mut self, saved: &[u8]) -> Result<(), CheckpointError> {
        let Saved { state, energies, first_known, rates, evaluations, largest } = decode(saved)?;
        let layout = self.equations.layout();
        layout.check(&state)?;
        expect("the list of rates", rates.len() == layout.len())?;
        finite("a rate", &rates)?;
        energies.iter().try_for_each(Energies::check)?;
        counts(&[evaluations])?;
        largest.check()?;
        self.first.place_mut().copy_from_slice(&state.values);
        self.first.rates_mut().copy_from_slice(&rates);
        (self.state, self.energies, self.first_known, self.branch_of_first) = (state, energies, first_known, None);
        (self.evaluations, self.largest) = (evaluations, largest);
        Ok(())
    }

    fn boxed_clone(&self) -> Box<dyn Motion> {
        Box::new(self.clone())
    }
}

impl<E: Equations, S: Scheme<E>> Stepper<E, S> {
    /// At a state.
    pub(crate) fn new(equations: E, scheme: S, state: State) -> Self {
        let evaluation = equations.evaluation();
        Self {
            scheme,
            next: state.clone(),
            before: state.clone(),
            coarse: state.clone(),
            state,
            first: evaluation.clone(),
            ahead: evaluation,
            first_known: false,
            branch_of_first: None,
            evaluations: 0,
            largest: Sizes::default(),
            norm: Arc::new(PlainNorm),
            energies: None,
            equations,
        }
    }

    /// Ready for step control in a run until `end`.
    pub(crate) fn measuring_errors(self, end: f64) -> Self {
        Self { largest: self.equations.sizes_of_loads(end), norm: self.equations.error_norm(end), ..self }
    }

    /// Tries two steps of length `h`, estimates their error against one of twice the length, and takes them if the
    /// estimate is not above `tolerance`.
    ///
    /// The states at the end differ by 2^order − 1 times the error of the finer one. An estimate from the stages of a
    /// single step would be cheaper, but all states of third order weigh a pure function of time by Simpson's rule as
    /// the fourth-order one does: such an estimate is blind to loads, and to modes faster than the step.
    ///
    /// The size of the error is the angle in the attitude or the largest of [`Sizes`], whichever is larger; the motion counts
    /// as not less than the loads are to cause.
    ///
    /// # Errors
    /// [`StepError`], where even the attempt fails; the state stays.
    fn controlled_steps(&mut self, h: f64, end: f64, tolerance: f64) -> Result<ErrorEstimate, StepError> {
        self.before.copy_from(&self.state);
        // Of the second of two steps: where the rates at its end are found.
        let branch_time = self.state.time + 1.5 * h;
        let estimate = self.two_steps(h, end);
        match estimate {
            Ok(estimate) if estimate.step <= tolerance => {
                self.largest = self.norm.motion(&self.equations, &self.next, &self.ahead).max(self.largest);
                self.energies = self.equations.energies(self.next.time, &self.ahead);
                std::mem::swap(&mut self.state, &mut self.next);
                // The evaluation at the end is the first of the next step.
                std::mem::swap(&mut self.first, &mut self.ahead);
                (self.first_known, self.branch_of_first) = (true, Some(branch_time));
                self.finish_first();
            }
            _ => {
                self.state.copy_from(&self.before);
                self.forget_first();
            }
        }
        estimate
    }

    /// Goes to `end` by one step of twice `h` and by two of `h`, the latter's end in `next`, and estimates its error.
    fn two_steps(&mut self, h: f64, end: f64) -> Result<ErrorEstimate, StepError> {
        let time = self.state.time;
        self.attempt(2.0 * h, end)?;
        self.coarse.copy_from(&self.next);
        // The first stage of both is the same.
        self.first_known = true;
        self.step(h, time + h)?;
        self.attempt(h, end)?;
        let Self { equations, next, coarse, ahead, first, norm, .. } = self;
        evaluate_at(equations, next, time + 1.5 * h, ahead).map_err(|error| error.in_step(time, h))?;
        self.evaluations += 1;
        let motion = norm.motion(equations, next, ahead).max(self.largest);
        let lowest = norm.lowest_frequency(equations);
        let relative = |sizes: Sizes| sizes.relative_to(motion, lowest);
        // By how much the difference exceeds the error of the finer steps.
        let gain = f64::from((1_u32 << S::ORDER) - 1);
        let seen = relative(norm.difference(equations, [next, coarse], 2.0 * h, gain));
        let angle = equations.layout().angle_between(&next.values, &coarse.values);
        let end = StepDone { state: next, e: ahead, before: first, since: h };
        let unseen = |step: f64| relative(norm.unseen(equations, step, &end));
        // A NaN stays one, and is rejected.
        let seen = if seen <= angle { angle } else { seen } / gain;
        let doubled = f64::from(1_u32 << (S::ORDER + 1));
        Ok(ErrorEstimate { step: seen + unseen(2.0 * h), doubled: doubled * seen + unseen(4.0 * h) })
    }

    /// Computes `next` from `state`.
    fn attempt(&mut self, h: f64, end: f64) -> Result<(), StepError> {
        let frame = self.equations.frame(&self.state);
        self.evaluate_first(&frame, h)?;
        let Self { equations, scheme, state, next, first, evaluations, .. } = self;
        let linear_part = !S::LINEAR_PART_IS_EXACT;
        let mut step = Step { equations, from: state, first, length: h, frame, linear_part, evaluations };
        scheme.step(&mut step, &mut next.values)?;
        if let Some(what) = equations.layout().not_finite(&next.values) {
            return Err(StepError::NotFinite { time: state.time, what });
        }
        equations.layout().turn(&state.values, &mut next.values);
        next.time = end;
        Ok(())
    }

    /// Evaluates the first stage at the state, unless the last step already has, or a row with the same loads.
    fn evaluate_first(&mut self, frame: &E::Frame, h: f64) -> Result<(), StepError> {
        if self.first_known {
            return Ok(());
        }
        let branch_time = self.state.time + 0.5 * h;
        // It counts as without the row.
        self.evaluations += 1;
        if self.first_holds_at(branch_time) {
            self.finish_first();
            return Ok(());
        }
        self.branch_of_first = None;
        let Self { equations, state, first, .. } = self;
        first.place_mut().copy_from_slice(&state.values);
        equations.rates([state.time, branch_time], frame, first).map_err(|error| error.in_step(state.time, h))?;
        self.energies = equations.energies(state.time, first);
        self.finish_first();
        Ok(())
    }

    /// Rows must not see the linear part.
    fn finish_first(&mut self) {
        if !S::LINEAR_PART_IS_EXACT {
            self.equations.add_linear(&mut self.first);
            self.branch_of_first = None;
        }
    }

    /// The state, or what acts on it, is another.
    fn forget_first(&mut self) {
        (self.first_known, self.branch_of_first) = (false, None);
    }

    /// True if `first` is the whole evaluation at the state, and the same by the branches that hold at a time.
    fn first_holds_at(&self, branch_time: f64) -> bool {
        let Self { equations, state, branch_of_first, .. } = self;
        branch_of_first.is_some_and(|branch| equations.acts_alike(state.time, [branch, branch_time]))
    }

    /// Evaluates the rates at the state for a row: in `first`, where the next step may find them, unless there are those
    /// that it needs; then in `ahead`. True of the former.
    fn evaluate_for_row(&mut self) -> Result<bool, RateError> {
        let time = self.state.time;
        if self.first_holds_at(time) {
            return Ok(true);
        }
        let Self { equations, state, first, ahead, .. } = self;
        if self.first_known {
            evaluate_at(equations, state, time, ahead)?;
            return Ok(false);
        }
        self.branch_of_first = None;
        evaluate_at(equations, state, time, first)?;
        self.branch_of_first = Some(time);
        Ok(true)
    }
}

/// The rates at a state, without the linear part.
fn evaluate_at<E: Equations>(
    equations: &E,
    state: &State,
    branch_time: f64,
    e: &mut E::Evaluation,
) -> Result<(), RateError> {
    e.place_mut().copy_from_slice(&state.values);
    equations.rates([state.time, branch_time], &equations.frame(state), e)
}
