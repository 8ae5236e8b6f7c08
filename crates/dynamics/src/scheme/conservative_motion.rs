//! Stepping the conservative form: RKMK4, exponential, and Strang splitting.

use std::any::Any;

use nalgebra::Matrix3;
use rigid_kin::Attitude;
use serde::{Deserialize, Serialize};

use crate::body::initial::Initial;
use crate::body::motion_state::MotionState;
use crate::body::shapes::PointShapes;
use crate::conservative::{ConservativeBody, ConservativeState, Evaluation, Slow, get, part};
use crate::error::{RateError, SetupError, StepError};
use crate::matrix::four::{Group, Padded, all_finite};
use crate::observation::Observation;
use crate::observation::energies::Energies;
use crate::observation::moment::Moment;
use crate::scheme::abilities::Abilities;
use crate::scheme::error_size::{ErrorSize, ORDER_GAIN, Sizes, StepEnd};
use crate::scheme::exponential::{BlockStore, Pairs, sum_of_blocks};
use crate::scheme::setup::{Beginning, Method, Setup, StepLimit};
use crate::scheme::{ErrorEstimate, Scheme};
use crate::simulation::checkpoint::{CheckpointError, counts, decode, encode, equal_room, expect, finite};
use crate::simulation::plan::StepControl;

/// How the conservative form is stepped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Stepping {
    /// Classical Runge–Kutta on the rotation vector of the step (Munthe-Kaas); order 4, stable to 2.83/ω_max.
    Rkmk4,
    /// Krogstad's ETD-RK4: modes exactly, the rest by four stages; order 4, no limit from the modes.
    Exponential,
}

/// A conservative body in motion.
#[derive(Debug, Clone)]
pub struct ConservativeMotion {
    body: ConservativeBody,
    scheme: Stepping,
    initial_attitude: Attitude,
    state: ConservativeState,
    next: ConservativeState,
    /// Under step control, the state before the steps that are tried, and their end by one long step.
    before: ConservativeState,
    coarse: ConservativeState,
    stages: [Evaluation; 4],
    /// Under step control, the evaluation at `next`.
    ahead: Evaluation,
    /// Whether `stages[0]` is that of `state`.
    first_known: bool,
    /// Where it is so or a row has made it so, and with all that was found on the way to the rates, the branch time.
    branch_of_first: Option<f64>,
    /// q and p at the end of the step.
    end_of_modes: [Padded; 2],
    blocks: BlockStore,
    evaluations: u64,
    /// Under step control, the largest sizes so far, not less than what the loads are to give.
    largest: Sizes,
    /// Under step control, what measures the errors of steps.
    error: ErrorSize,
    /// Energies at the start of the last step; none of a driven body, whose drive may jump.
    energies: Option<Energies>,
}

/// What a checkpoint keeps.
#[derive(Serialize, Deserialize)]
struct Saved {
    state: ConservativeState,
    #[serde(with = "equal_room")]
    energies: Option<Energies>,
    first_known: bool,
    /// Of `stages[0]`.
    rates: (Slow, Vec<f64>, Vec<f64>),
    #[serde(with = "postcard::fixint::le")]
    evaluations: u64,
    largest: Sizes,
}

/// Classical Runge–Kutta in the list of schemes.
pub(crate) const RKMK4: Method = Method {
    formulation: "conservative",
    scheme: "rkmk4",
    order: 4,
    evaluations_per_step: 4,
    limit: StepLimit::Modes,
    estimates_error: true,
    abilities: Abilities::ALL,
    begin: |setup| begin(setup, Stepping::Rkmk4),
};

/// The exponential scheme in the list of schemes.
///
/// Coriolis terms turn the modes with up to twice the spin, which the stages of RK4 follow to 2.83 in the step.
pub(crate) const EXPONENTIAL: Method = Method {
    formulation: "conservative",
    scheme: "exponential",
    order: 4,
    evaluations_per_step: 4,
    limit: StepLimit::Turn(std::f64::consts::SQRT_2),
    estimates_error: true,
    abilities: Abilities::ALL,
    begin: |setup| begin(setup, Stepping::Exponential),
};

fn begin(setup: &Setup, scheme: Stepping) -> Result<Beginning, SetupError> {
    let body = ConservativeBody::new(setup.body, setup.damping_ratios, setup.loads.to_vec(), setup.physics)?;
    let energy_of_loads = setup.energy_of_loads_on(&body);
    let mut motion = ConservativeMotion::new(body, scheme, setup.initial)?;
    if let StepControl::Tolerance(_) = setup.control {
        motion.largest = motion.body.sizes_of_loads(setup.end);
        motion.error = ErrorSize::new(&motion.body, setup.end);
    }
    Ok(Beginning { scheme: Box::new(motion), energy_of_loads })
}

impl Scheme for ConservativeMotion {
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

    /// The rates at the end of the last step are not those of the next one's beginning, and a drive may jump.
    fn pass_corner(&mut self) -> Result<(), StepError> {
        self.forget_first();
        let Self { body, state, ahead, .. } = self;
        let time = state.time;
        body.pass_jump(state, ahead).map_err(|error| error.in_step(time, 0.0))
    }

    fn loads_have_changed(&mut self) {
        self.forget_first();
    }

    fn raise_energy_of_loads(&mut self, end: f64) -> f64 {
        let sizes = self.body.sizes_of_loads(end);
        self.largest = self.largest.max(sizes);
        sizes.energy
    }

    fn observe(&mut self, points: &[PointShapes], out: &mut Observation) -> Result<(), StepError> {
        let in_first = self.evaluate_for_row().map_err(|error| error.in_step(self.state.time, 0.0))?;
        let Self { body, initial_attitude, state, stages: [first, ..], ahead, .. } = self;
        let e = if in_first { first } else { ahead };
        body.observe(state, initial_attitude, points, e, out).map_err(|error| error.in_step(state.time, 0.0))?;
        self.energies = body.energies_of(state.time, &state.slow, e);
        Ok(())
    }

    fn state(&self) -> Result<MotionState, StepError> {
        let Self { body, state, .. } = self;
        body.motion_state(state).map_err(|error| error.in_step(state.time, 0.0))
    }

    fn set_state(&mut self, to: &MotionState) -> Result<(), SetupError> {
        let set = self.body.state_of(to)?;
        self.set_momentum_state(&set)
    }

    fn copy_state(&mut self, from: &dyn Scheme) {
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
    fn moment(&self) -> Moment<'_> {
        let Evaluation { omega_body, modal_velocity, .. } = &self.stages[0];
        let (time, q) = match self.first_known || self.branch_of_first.is_some() {
            true => (self.state.time, &self.state.modal_displacement),
            // The states have changed places at the end of the step.
            false => (self.next.time, &self.next.modal_displacement),
        };
        Moment { time, omega_body: *omega_body, modal_displacement: q, modal_velocity }
    }

    fn work_and_dissipation(&self) -> [f64; 2] {
        [self.state.slow[part::WORK], self.state.slow[part::DISSIPATION]]
    }

    fn fastest_rate(&self) -> f64 {
        self.body.fastest_rate()
    }

    fn evaluations(&self) -> u64 {
        self.evaluations
    }

    fn flexible(&self) -> usize {
        self.body.flexible()
    }

    fn save(&self) -> Result<Vec<u8>, CheckpointError> {
        // Of a known evaluation the stages read the rates only.
        let Evaluation { slow, displacement, momentum, .. } = self.stages[0].clone();
        encode(&Saved {
            state: self.state.clone(),
            energies: self.energies,
            first_known: self.first_known,
            rates: (slow, displacement.to_vec(), momentum.to_vec()),
            evaluations: self.evaluations,
            largest: self.largest,
        })
    }

    fn restore(&mut self, saved: &[u8]) -> Result<(), CheckpointError> {
        let Saved { state, energies, first_known, rates: (slow, displacement, momentum), evaluations, largest } =
            decode(saved)?;
        let nf = self.body.flexible();
        state.check(nf)?;
        expect("a list of rates", displacement.len() == nf && momentum.len() == nf)?;
        finite("a rate", slow.iter().chain(&displacement).chain(&momentum))?;
        energies.iter().try_for_each(Energies::check)?;
        counts(&[evaluations])?;
        largest.check()?;
        let first = &mut self.stages[0];
        first.slow = slow;
        for (list, saved) in [
            (&mut first.displacement, &displacement),
            (&mut first.momentum, &momentum),
            (&mut first.q, &state.modal_displacement),
            (&mut first.p, &state.modal_momentum),
        ] {
            list.copy_from_slice(saved);
        }
        (self.state, self.energies, self.first_known, self.branch_of_first) = (state, energies, first_known, None);
        (self.evaluations, self.largest) = (evaluations, largest);
        Ok(())
    }

    fn boxed_clone(&self) -> Box<dyn Scheme> {
        Box::new(self.clone())
    }
}

impl ConservativeMotion {
    /// A motion from `initial`.
    ///
    /// # Errors
    /// [`SetupError`] for lists of the wrong length and numbers that are not finite.
    pub(crate) fn new(body: ConservativeBody, scheme: Stepping, initial: &Initial) -> Result<Self, SetupError> {
        let state = body.start(initial)?;
        let nf = body.flexible();
        let evaluation = body.evaluation();
        Ok(Self {
            scheme,
            initial_attitude: initial.attitude,
            next: state.clone(),
            before: state.clone(),
            coarse: state.clone(),
            state,
            stages: std::array::from_fn(|_| evaluation.clone()),
            ahead: evaluation,
            first_known: false,
            branch_of_first: None,
            end_of_modes: std::array::from_fn(|_| Padded::zeros(nf)),
            blocks: BlockStore::default(),
            evaluations: 0,
            largest: Sizes::default(),
            error: ErrorSize::default(),
            energies: None,
            body,
        })
    }

    /// The state that has been reached, with its momenta.
    pub fn momentum_state(&self) -> &ConservativeState {
        &self.state
    }

    /// Goes on from another state.
    ///
    /// # Errors
    /// [`SetupError`] for lists of the wrong length and numbers that are not finite.
    pub fn set_momentum_state(&mut self, to: &ConservativeState) -> Result<(), SetupError> {
        to.check(self.body.flexible())?;
        self.state.copy_from(to);
        self.forget_first();
        self.energies = None;
        Ok(())
    }

    /// The body and its loads.
    pub fn body(&self) -> &ConservativeBody {
        &self.body
    }

    /// Tries two steps of length `h`, estimates their error against one of twice the length, and takes them if the
    /// estimate is not above `tolerance`.
    ///
    /// The answers at the end differ by 2⁴ − 1 times the error of the finer one. An estimate from the stages of a
    /// single step would be cheaper, but all answers of third order weigh a pure function of time by Simpson's rule as
    /// the fourth-order one does: such an estimate is blind to loads, and to modes faster than the step.
    ///
    /// The size of the error is the angle in the attitude or the largest of [`Sizes`], whichever is larger; the motion counts
    /// as not less than what the loads are to give it.
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
                self.largest = self.body.sizes(&self.next, &self.ahead).max(self.largest);
                let ConservativeState { time, slow, .. } = &self.next;
                self.energies = self.body.energies_of(*time, slow, &self.ahead);
                std::mem::swap(&mut self.state, &mut self.next);
                // The evaluation at the end is the first of the next step.
                std::mem::swap(&mut self.stages[0], &mut self.ahead);
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
        let Self { body, next, coarse, ahead, stages, error, .. } = self;
        body.evaluate_at(next, time + 1.5 * h, ahead).map_err(|error| error.in_step(time, h))?;
        self.evaluations += 1;
        let motion = body.sizes(next, ahead).max(self.largest);
        let relative = |sizes: Sizes| sizes.relative_to(motion, body.lowest_frequency());
        let seen = relative(error.of_difference(body, next, coarse, 2.0 * h));
        let angle = next.attitude.angle_to(&coarse.attitude);
        let end = StepEnd { state: next, e: ahead, force_before: &stages[0].momentum, since: h };
        let unseen = |step: f64| relative(error.unseen(body, step, &end));
        // A NaN stays one, and is rejected.
        let seen = if seen <= angle { angle } else { seen } / ORDER_GAIN;
        Ok(ErrorEstimate { step: seen + unseen(2.0 * h), doubled: 32.0 * seen + unseen(4.0 * h) })
    }

    /// Computes `next` from `state`.
    fn attempt(&mut self, h: f64, end: f64) -> Result<(), StepError> {
        let first_attitude = self.state.attitude.global_to_body();
        self.evaluate_first(&first_attitude, h)?;
        match self.scheme {
            Stepping::Rkmk4 => self.rkmk4(&first_attitude, h)?,
            Stepping::Exponential => self.exponential(&first_attitude, h)?,
        }
        let Self { body, state, next, end_of_modes: [q, p], .. } = self;
        next.modal_displacement.copy_from_slice(q);
        next.modal_momentum.copy_from_slice(p);
        let theta = get(&next.slow, part::THETA);
        next.attitude = state.attitude.advanced_by(&theta);
        if let [axis] = body.axes[..] {
            next.turned = state.turned + axis.dot(&theta);
        }
        next.slow.fixed_rows_mut::<3>(part::THETA).fill(0.0);
        next.time = end;
        let infinite = |what| Err(StepError::NotFinite { time: state.time, what });
        if !all_finite(next.slow.as_slice()) {
            return infinite("a momentum, the position or the work");
        }
        if !(all_finite(q) && all_finite(p)) {
            return infinite("a modal coordinate");
        }
        Ok(())
    }

    /// Evaluates stage `s` at its q and p, the stage values `slow` and time `t`.
    fn evaluate(
        &mut self,
        s: usize,
        t: f64,
        first_attitude: &Matrix3<f64>,
        slow: &Slow,
        h: f64,
    ) -> Result<(), StepError> {
        let Self { body, state, stages, .. } = self;
        self.evaluations += 1;
        let branch_time = state.time + 0.5 * h;
        body.evaluate([t, branch_time], first_attitude, slow, &mut stages[s])
            .map_err(|error| error.in_step(state.time, h))
    }

    /// Evaluates the first stage at the state, unless the last step already has, or a row with the same loads.
    fn evaluate_first(&mut self, first_attitude: &Matrix3<f64>, h: f64) -> Result<(), StepError> {
        if self.first_known {
            return Ok(());
        }
        if self.first_holds_at(self.state.time + 0.5 * h) {
            // It counts as without the row.
            self.evaluations += 1;
            self.finish_first();
            return Ok(());
        }
        self.branch_of_first = None;
        let Self { state, stages: [first, ..], .. } = self;
        first.q.copy_from_slice(&state.modal_displacement);
        first.p.copy_from_slice(&state.modal_momentum);
        let slow = state.slow;
        self.evaluate(0, self.state.time, first_attitude, &slow, h)?;
        self.energies = self.body.energies_of(self.state.time, &slow, &self.stages[0]);
        self.finish_first();
        Ok(())
    }

    /// The stages of RK4 take the linear part from the rates, which rows must not see.
    fn finish_first(&mut self) {
        if self.scheme == Stepping::Rkmk4 {
            self.body.add_linear(&mut self.stages[0]);
            self.branch_of_first = None;
        }
    }

    /// The state, or what acts on it, is another.
    fn forget_first(&mut self) {
        (self.first_known, self.branch_of_first) = (false, None);
    }

    /// Whether `stages[0]` is the whole evaluation at the state, and the same by the branches that hold at a time.
    fn first_holds_at(&self, branch_time: f64) -> bool {
        let Self { body, state, branch_of_first, .. } = self;
        branch_of_first.is_some_and(|branch| body.acts_alike(state.time, [branch, branch_time]))
    }

    /// Evaluates the rates at the state for a row: in `stages[0]`, where the next step may find them, unless there are those
    /// that it needs; then in `ahead`. Whether it is the former.
    fn evaluate_for_row(&mut self) -> Result<bool, RateError> {
        let time = self.state.time;
        if self.first_holds_at(time) {
            return Ok(true);
        }
        if self.first_known {
            self.body.evaluate_at(&self.state, time, &mut self.ahead)?;
            return Ok(false);
        }
        self.branch_of_first = None;
        self.body.evaluate_at(&self.state, time, &mut self.stages[0])?;
        self.branch_of_first = Some(time);
        Ok(true)
    }

    /// Stages 2 to 4 of classical RK4 and the sum.
    fn rkmk4(&mut self, first_attitude: &Matrix3<f64>, h: f64) -> Result<(), StepError> {
        let time = self.state.time;
        for (s, fraction) in [(1, 0.5), (2, 0.5), (3, 1.0)] {
            let (before, now) = self.stages.split_at_mut(s);
            let (before, now, c) = (&before[s - 1], &mut now[0], fraction * h);
            add_scaled(&self.state.modal_displacement, c, &before.displacement, &mut now.q);
            add_scaled(&self.state.modal_momentum, c, &before.momentum, &mut now.p);
            let slow = self.state.slow + before.slow * c;
            self.evaluate(s, time + c, first_attitude, &slow, h)?;
            self.body.add_linear(&mut self.stages[s]);
        }
        let Self { state, next, stages: [k1, k2, k3, k4], end_of_modes: [q, p], .. } = self;
        let w = h / 6.0;
        next.slow = state.slow + (k1.slow + (k2.slow + k3.slow) * 2.0 + k4.slow) * w;
        for k in 0..q.len() {
            let sum =
                |part: fn(&Evaluation) -> &[f64]| w * (part(k1)[k] + 2.0 * (part(k2)[k] + part(k3)[k]) + part(k4)[k]);
            q[k] = state.modal_displacement[k] + sum(|e| &e.displacement);
            p[k] = state.modal_momentum[k] + sum(|e| &e.momentum);
        }
        Ok(())
    }

    fn exponential(&mut self, first_attitude: &Matrix3<f64>, h: f64) -> Result<(), StepError> {
        let Self { body, blocks, state, next, stages, end_of_modes: [q, p], evaluations, .. } = self;
        let block = blocks.get(&body.circular_frequencies, &body.damping_ratios, h);
        let branch_time = state.time + 0.5 * h;
        for (s, fraction) in [(1, 0.5), (2, 0.5), (3, 1.0)] {
            let [first, second, third, fourth] = &mut *stages;
            let start = first.place_of_modes();
            match s {
                1 => sum_of_blocks([(&block.half, start), (&block.a21, first.rates_of_modes())], second.modes_mut()),
                2 => sum_of_blocks(
                    [(&block.half, start), (&block.a31, first.rates_of_modes()), (&block.a32, second.rates_of_modes())],
                    third.modes_mut(),
                ),
                _ => sum_of_blocks(
                    [(&block.full, start), (&block.a41, first.rates_of_modes()), (&block.a43, third.rates_of_modes())],
                    fourth.modes_mut(),
                ),
            }
            let slow = state.slow + stages[s - 1].slow * (fraction * h);
            *evaluations += 1;
            body.evaluate([state.time + fraction * h, branch_time], first_attitude, &slow, &mut stages[s])
                .map_err(|error| error.in_step(state.time, h))?;
        }
        let [k1, k2, k3, k4] = stages.each_ref().map(|stage| &stage.slow);
        next.slow = state.slow + (k1 + (k2 + k3) * 2.0 + k4) * (h / 6.0);
        let [n1, n2, n3, n4] = stages.each_ref().map(Evaluation::rates_of_modes);
        let start = stages[0].place_of_modes();
        let terms = [(&block.full, start), (&block.b1, n1), (&block.b2, n2), (&block.b2, n3), (&block.b4, n4)];
        sum_of_blocks(terms, [q.groups_mut(), p.groups_mut()]);
        Ok(())
    }
}

impl Evaluation {
    /// q and p.
    fn place_of_modes(&self) -> Pairs<'_> {
        [self.q.groups(), self.p.groups()]
    }

    fn modes_mut(&mut self) -> [&mut [Group]; 2] {
        [self.q.groups_mut(), self.p.groups_mut()]
    }

    /// Rates of q and p, without the linear part.
    fn rates_of_modes(&self) -> Pairs<'_> {
        [self.displacement.groups(), self.momentum.groups()]
    }
}

/// out = x + c·y
fn add_scaled(x: &[f64], c: f64, y: &[f64], out: &mut [f64]) {
    for ((out, x), y) in out.iter_mut().zip(x).zip(y) {
        *out = x + c * y;
    }
}
