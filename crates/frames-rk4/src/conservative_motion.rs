//! Stepping the conservative form: RKMK4, exponential, and Strang splitting.

use nalgebra::Vector2;

use crate::conservative::{ConservativeBody, ConservativeState, Evaluation, Slow, get, part};
use crate::error::{SetupError, StepError};
use crate::exponential::{BlockStore, StepBlocks, apply};
use crate::initial::Initial;
use crate::motion::PointShapes;
use crate::observation::Observation;

/// How the conservative form is stepped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ConservativeScheme {
    /// Classical Runge–Kutta on the rotation vector of the step (Munthe-Kaas); order 4, stable to 2.83/ω_max.
    Rkmk4,
    /// Krogstad's ETD-RK4: modes exactly, the rest by four stages; order 4, no limit from the modes.
    Exponential,
    /// Half a step of the modes exactly, a whole one of the rest, half a step of the modes; order 2, no limit from
    /// the modes, no secular drift.
    Strang,
}

/// A conservative body in motion.
#[derive(Debug, Clone)]
pub struct ConservativeMotion {
    body: ConservativeBody,
    scheme: ConservativeScheme,
    state: ConservativeState,
    next: ConservativeState,
    stages: [Evaluation; 4],
    /// Evaluation at `next`, which is the first of the next step; only with an error estimate.
    ahead: Evaluation,
    /// Whether `stages[0]` is that of `state`.
    first_known: bool,
    /// Where the stages start from in the modes; for Strang, the state after half a step of the modes alone.
    start_q: Vec<f64>,
    start_p: Vec<f64>,
    /// Stage values of the modes.
    q: Vec<f64>,
    p: Vec<f64>,
    blocks: BlockStore,
    evaluations: u64,
    /// Largest energy so far, that of the centre's motion left out.
    energy_scale: f64,
}

impl ConservativeMotion {
    /// A motion from `initial`.
    ///
    /// # Errors
    /// [`SetupError`] for lists of the wrong length and numbers that are not finite.
    pub fn new(body: ConservativeBody, scheme: ConservativeScheme, initial: &Initial) -> Result<Self, SetupError> {
        let state = body.start(initial)?;
        let nf = body.flexible();
        let evaluation = Evaluation::new(nf);
        Ok(Self {
            scheme,
            next: state.clone(),
            state,
            stages: std::array::from_fn(|_| evaluation.clone()),
            ahead: evaluation,
            first_known: false,
            start_q: vec![0.0; nf],
            start_p: vec![0.0; nf],
            q: vec![0.0; nf],
            p: vec![0.0; nf],
            blocks: BlockStore::default(),
            evaluations: 0,
            energy_scale: 0.0,
            body,
        })
    }

    /// The state that has been reached.
    pub fn state(&self) -> &ConservativeState {
        &self.state
    }

    /// Evaluations of the rates so far.
    pub fn evaluations(&self) -> u64 {
        self.evaluations
    }

    /// Does one step of length `h` that ends at time `end` (= time + h but for rounding).
    ///
    /// # Errors
    /// [`StepError`]; the state stays that before the step.
    pub fn step(&mut self, h: f64, end: f64) -> Result<(), StepError> {
        self.attempt(h, end)?;
        std::mem::swap(&mut self.state, &mut self.next);
        self.first_known = false;
        Ok(())
    }

    /// Tries a step, estimates its error, and takes it if the estimate is not above `tolerance`.
    ///
    /// The estimate costs one evaluation, which is the first of the next step: it is the difference to the third-order
    /// answer that weighs that one instead of the fourth stage. Its size is the square root of its energy over the
    /// largest energy of the motion so far (about the centre of mass), or the angle in the attitude, whichever is
    /// larger.
    ///
    /// # Errors
    /// [`StepError`], where even the attempt fails.
    pub(crate) fn controlled_step(&mut self, h: f64, end: f64, tolerance: f64) -> Result<f64, StepError> {
        let time = self.state.time;
        self.attempt(h, end)?;
        let Self { body, next, ahead, .. } = self;
        body.evaluate(end, &next.attitude, &next.slow, &next.modal_displacement, &next.modal_momentum, ahead)
            .map_err(|error| error.in_step(time, h))?;
        self.evaluations += 1;
        let scale = body.internal_energy(next, ahead).max(self.energy_scale);
        if self.scheme == ConservativeScheme::Rkmk4 {
            body.add_linear(&next.modal_displacement, &next.modal_momentum, ahead);
        }
        let impulse = self.body.impulse_error(time, h);
        let (energy, angle) = self.error_of_step(h);
        let root = energy.sqrt() + impulse;
        let relative = if root == 0.0 { 0.0 } else { root / scale.sqrt() };
        // A NaN stays one, and is rejected.
        let estimate = if relative <= angle { angle } else { relative };
        if estimate <= tolerance {
            self.energy_scale = scale;
            std::mem::swap(&mut self.state, &mut self.next);
            std::mem::swap(&mut self.stages[0], &mut self.ahead);
            self.first_known = true;
        }
        Ok(estimate)
    }

    /// Energy and angle of the difference between the fourth- and the third-order answer.
    fn error_of_step(&mut self, h: f64) -> (f64, f64) {
        let Self { body, scheme, blocks, stages: [.., fourth], ahead, .. } = self;
        let slow = (fourth.slow - ahead.slow) * (h / 6.0);
        let mut energy = body.rigid_energy(&slow);
        let difference =
            |k: usize| (fourth.displacement[k] - ahead.displacement[k], fourth.momentum[k] - ahead.momentum[k]);
        match scheme {
            ConservativeScheme::Exponential => {
                let blocks = blocks.get(&body.circular_frequencies, &body.damping_ratios, h);
                for (k, block) in blocks.modes.iter().enumerate() {
                    let (q, p) = difference(k);
                    let error = apply(&block.b4, q, p);
                    energy += body.modal_energy(k, error.x, error.y);
                }
            }
            ConservativeScheme::Rkmk4 | ConservativeScheme::Strang => {
                for k in 0..body.flexible() {
                    let (q, p) = difference(k);
                    energy += body.modal_energy(k, q * h / 6.0, p * h / 6.0);
                }
            }
        }
        let turn = (fourth.omega_body - ahead.omega_body) * (h / 6.0);
        (energy, turn.norm())
    }

    /// Fills `out` with the motion at the state, and that of `points`.
    ///
    /// # Errors
    /// [`StepError`] where the inertia of the deformed body is singular.
    pub fn observe(&mut self, points: &[PointShapes], out: &mut Observation) -> Result<(), StepError> {
        self.body
            .observe(&self.state, points, &mut self.ahead, out)
            .map_err(|error| error.in_step(self.state.time, 0.0))
    }

    /// Computes `next` from `state`.
    fn attempt(&mut self, h: f64, end: f64) -> Result<(), StepError> {
        match self.scheme {
            ConservativeScheme::Rkmk4 => self.rkmk4(h)?,
            ConservativeScheme::Exponential => self.exponential(h)?,
            ConservativeScheme::Strang => self.strang(h)?,
        }
        let Self { state, next, .. } = self;
        let theta = get(&next.slow, part::THETA);
        next.attitude = state.attitude.advanced_by(&theta);
        next.slow.fixed_rows_mut::<3>(part::THETA).fill(0.0);
        next.time = end;
        let modes = next.modal_displacement.iter().chain(&next.modal_momentum);
        if modes.chain(next.slow.iter()).all(|x| x.is_finite()) {
            Ok(())
        } else {
            Err(StepError::NotFinite { time: state.time, what: "the state" })
        }
    }

    /// Evaluates stage `s` at the stage values `slow`, q, p and time `t`.
    fn evaluate(&mut self, s: usize, t: f64, slow: &Slow, h: f64) -> Result<(), StepError> {
        let Self { body, state, stages, q, p, .. } = self;
        self.evaluations += 1;
        body.evaluate(t, &state.attitude, slow, q, p, &mut stages[s]).map_err(|error| error.in_step(state.time, h))
    }

    /// Evaluates the first stage at the start of the stages, unless the last step already has.
    fn evaluate_first(&mut self, h: f64) -> Result<(), StepError> {
        if self.first_known {
            return Ok(());
        }
        self.q.copy_from_slice(&self.start_q);
        self.p.copy_from_slice(&self.start_p);
        let slow = self.state.slow;
        self.evaluate(0, self.state.time, &slow, h)?;
        if self.scheme == ConservativeScheme::Rkmk4 {
            self.body.add_linear(&self.q, &self.p, &mut self.stages[0]);
        }
        Ok(())
    }

    /// The stages start from the state.
    fn start_from_state(&mut self) {
        self.start_q.copy_from_slice(&self.state.modal_displacement);
        self.start_p.copy_from_slice(&self.state.modal_momentum);
    }

    fn rkmk4(&mut self, h: f64) -> Result<(), StepError> {
        self.start_from_state();
        self.evaluate_first(h)?;
        self.runge_kutta(h, true)
    }

    /// Stages 2 to 4 of classical RK4 and the sum, into `next`; with or without the linear part of the modes.
    fn runge_kutta(&mut self, h: f64, with_linear: bool) -> Result<(), StepError> {
        let time = self.state.time;
        for (s, fraction) in [(1, 0.5), (2, 0.5), (3, 1.0)] {
            let before = &self.stages[s - 1];
            let c = fraction * h;
            add_scaled(&self.start_q, c, &before.displacement, &mut self.q);
            add_scaled(&self.start_p, c, &before.momentum, &mut self.p);
            let slow = self.state.slow + before.slow * c;
            self.evaluate(s, time + c, &slow, h)?;
            if with_linear {
                self.body.add_linear(&self.q, &self.p, &mut self.stages[s]);
            }
        }
        let Self { state, next, stages: [k1, k2, k3, k4], start_q, start_p, .. } = self;
        let w = h / 6.0;
        next.slow = state.slow + (k1.slow + (k2.slow + k3.slow) * 2.0 + k4.slow) * w;
        for k in 0..next.modal_displacement.len() {
            let sum =
                |part: fn(&Evaluation) -> &[f64]| w * (part(k1)[k] + 2.0 * (part(k2)[k] + part(k3)[k]) + part(k4)[k]);
            next.modal_displacement[k] = start_q[k] + sum(|e| &e.displacement);
            next.modal_momentum[k] = start_p[k] + sum(|e| &e.momentum);
        }
        Ok(())
    }

    fn exponential(&mut self, h: f64) -> Result<(), StepError> {
        self.start_from_state();
        self.evaluate_first(h)?;
        let time = self.state.time;
        let nf = self.q.len();
        for (s, fraction) in [(1, 0.5), (2, 0.5), (3, 1.0)] {
            let Self { body, blocks, state, stages, q, p, .. } = self;
            let blocks = blocks.get(&body.circular_frequencies, &body.damping_ratios, h);
            for k in 0..nf {
                let block = &blocks.modes[k];
                let start = (state.modal_displacement[k], state.modal_momentum[k]);
                let n = |stage: usize| (stages[stage].displacement[k], stages[stage].momentum[k]);
                let value = match s {
                    1 => at(&block.half, start) + at(&block.a21, n(0)),
                    2 => at(&block.half, start) + at(&block.a31, n(0)) + at(&block.a32, n(1)),
                    _ => at(&block.full, start) + at(&block.a41, n(0)) + at(&block.a43, n(2)),
                };
                (q[k], p[k]) = (value.x, value.y);
            }
            let slow = state.slow + stages[s - 1].slow * (fraction * h);
            self.evaluate(s, time + fraction * h, &slow, h)?;
        }
        let Self { body, blocks, state, next, stages: [k1, k2, k3, k4], .. } = self;
        let blocks = blocks.get(&body.circular_frequencies, &body.damping_ratios, h);
        next.slow = state.slow + (k1.slow + (k2.slow + k3.slow) * 2.0 + k4.slow) * (h / 6.0);
        for k in 0..nf {
            let block = &blocks.modes[k];
            let middle = (k2.displacement[k] + k3.displacement[k], k2.momentum[k] + k3.momentum[k]);
            let value = at(&block.full, (state.modal_displacement[k], state.modal_momentum[k]))
                + at(&block.b1, (k1.displacement[k], k1.momentum[k]))
                + at(&block.b2, middle)
                + at(&block.b4, (k4.displacement[k], k4.momentum[k]));
            next.modal_displacement[k] = value.x;
            next.modal_momentum[k] = value.y;
        }
        Ok(())
    }

    fn strang(&mut self, h: f64) -> Result<(), StepError> {
        self.start_from_state();
        let Self { body, blocks, start_q, start_p, .. } = self;
        let blocks_of_step = blocks.get(&body.circular_frequencies, &body.damping_ratios, h);
        half_step(blocks_of_step, start_q, start_p);
        self.evaluate_first(h)?;
        self.runge_kutta(h, false)?;
        let Self { body, blocks, next, .. } = self;
        let blocks_of_step = blocks.get(&body.circular_frequencies, &body.damping_ratios, h);
        half_step(blocks_of_step, &mut next.modal_displacement, &mut next.modal_momentum);
        Ok(())
    }
}

/// The modes alone, exactly, for half a step.
fn half_step(blocks: &StepBlocks, q: &mut [f64], p: &mut [f64]) {
    for (block, (q, p)) in blocks.modes.iter().zip(q.iter_mut().zip(p)) {
        let value = apply(&block.half, *q, *p);
        (*q, *p) = (value.x, value.y);
    }
}

fn at(block: &nalgebra::Matrix2<f64>, (q, p): (f64, f64)) -> Vector2<f64> {
    apply(block, q, p)
}

/// out = x + c·y
fn add_scaled(x: &[f64], c: f64, y: &[f64], out: &mut [f64]) {
    for ((out, x), y) in out.iter_mut().zip(x).zip(y) {
        *out = x + c * y;
    }
}
