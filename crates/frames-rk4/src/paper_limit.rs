//! The paper's physics at fourth order: one consistent frame per step, Runge–Kutta–Munthe-Kaas.
//!
//! All components of the state turn with the frame, whose rotation vector θ starts each step at zero:
//!
//! ```text
//! θ' = f⁻¹(θ) ω(y)
//! q' = y − G(ω) q  in the flexible rows,  −G(ω) q  in the rigid ones (the remainder that the frame has not taken)
//! y' = f_q(t, A(θ)) − Λ q − D y − G(ω) y,      G(ω) = Ψᵀ M (I⊗[ω×]) Ψ
//! ```
//!
//! It has the limit of the paper's scheme for Δt → 0, and costs the same for a step.

use std::any::Any;

use modal::ReducedBody;
use nalgebra::Vector3;
use rigid_kin::{f_inverse, transformation_matrix};
use serde::{Deserialize, Serialize};

use crate::attitude_account::AttitudeAccount;
use crate::checkpoint::{CheckpointError, counts, decode, encode, finite};
use crate::energies::Energies;
use crate::error::{RateError, SetupError, StepError};
use crate::initial::Initial;
use crate::load::Coordinates;
use crate::model::{LinearMotion, ModalModel};
use crate::moment::Moment;
use crate::motion::{BodyMotion, PointShapes};
use crate::observation::Observation;
use crate::paper::{STEPS_OF_ATTITUDE, refuse_beyond_paper};
use crate::scheme::Scheme;
use crate::setup::{Method, StepLimit};
use crate::state::{MotionState, State, rotation};
use crate::work::Work;

/// Steps the limit of the paper's scheme by RKMK4.
#[derive(Debug, Clone)]
pub struct PaperLimit {
    model: ModalModel,
    motion: BodyMotion,
    /// G_1, G_2, G_3 of all modes, column by column, one below another (3 (6+nf) × (6+nf)).
    cross_products: Vec<f64>,
    state: State,
    work: Work,
    stages: [Rates; 4],
    q: Vec<f64>,
    y: Vec<f64>,
    products: Vec<f64>,
    evaluations: u64,
    steps_done: u64,
    attitude_account: AttitudeAccount,
    longest_step: f64,
}

/// What a checkpoint keeps.
#[derive(Serialize, Deserialize)]
struct Saved {
    state: State,
    work: Work,
    #[serde(with = "postcard::fixint::le")]
    evaluations: u64,
    #[serde(with = "postcard::fixint::le")]
    steps_done: u64,
    longest_step: f64,
    attitude_account: AttitudeAccount,
}

#[derive(Debug, Clone)]
struct Rates {
    /// θ'
    rotation_vector: Vector3<f64>,
    /// r', global.
    origin: Vector3<f64>,
    work: Work,
    displacement: Vec<f64>,
    velocity: Vec<f64>,
}

impl PaperLimit {
    /// A motion of `body` from `initial`.
    ///
    /// # Errors
    /// [`SetupError`] for lists of the wrong length and numbers that are not finite.
    pub fn new(body: &ReducedBody, model: ModalModel, initial: &Initial) -> Result<Self, SetupError> {
        model.check_body(body)?;
        let motion = BodyMotion::new(body)?.beginning_at(initial.attitude);
        let state = State::begin(body, initial)?;
        let size = state.modal_displacement.len();
        // [e_1×] = e_3 e_2ᵀ − e_2 e_3ᵀ and cyclic.
        let cross_products = (0..size)
            .flat_map(|j| {
                [(2, 1), (0, 2), (1, 0)].into_iter().flat_map(move |(a, b)| {
                    let (ab, ba) = (&body.rotation_products[a][b], &body.rotation_products[b][a]);
                    (0..size).map(move |i| ab[(i, j)] - ba[(i, j)])
                })
            })
            .collect();
        let zeros = || vec![0.0; size];
        let rates = Rates {
            rotation_vector: Vector3::zeros(),
            origin: Vector3::zeros(),
            work: Work::default(),
            displacement: zeros(),
            velocity: zeros(),
        };
        let mut limit = Self {
            model,
            motion,
            cross_products,
            state,
            work: Work::default(),
            stages: std::array::from_fn(|_| rates.clone()),
            q: zeros(),
            y: zeros(),
            products: vec![0.0; 3 * size],
            evaluations: 0,
            steps_done: 0,
            attitude_account: AttitudeAccount::default(),
            longest_step: 0.0,
        };
        limit.complete_state(0.0);
        Ok(limit)
    }

    /// The state that has been reached.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Does one step of classical Runge–Kutta.
    fn take_step(&mut self, h: f64, end: f64) -> Result<(), StepError> {
        let time = self.state.time;
        let inside = time + 0.5 * h;
        for (s, fraction) in [0.0, 0.5, 0.5, 1.0].into_iter().enumerate() {
            let c = fraction * h;
            let mut theta = Vector3::zeros();
            self.q.copy_from_slice(&self.state.modal_displacement);
            self.y.copy_from_slice(&self.state.modal_velocity);
            if s > 0 {
                let before = &self.stages[s - 1];
                theta = before.rotation_vector * c;
                add(&mut self.q, c, &before.displacement);
                add(&mut self.y, c, &before.velocity);
            }
            self.evaluate(s, time + c, inside, &theta).map_err(|error| error.in_step(time, h))?;
        }
        let Self { state, stages, q, y, work, .. } = self;
        q.copy_from_slice(&state.modal_displacement);
        y.copy_from_slice(&state.modal_velocity);
        let (mut theta, mut moved) = (Vector3::zeros(), Vector3::zeros());
        let mut done = *work;
        for (stage, weight) in stages.iter().zip([h / 6.0, h / 3.0, h / 3.0, h / 6.0]) {
            theta += stage.rotation_vector * weight;
            moved += stage.origin * weight;
            done.add(weight, &stage.work);
            add(q, weight, &stage.displacement);
            add(y, weight, &stage.velocity);
        }
        if !q.iter().chain(y.iter()).chain(&theta).chain(&moved).all(|x| x.is_finite()) {
            return Err(StepError::NotFinite { time, what: "a modal coordinate" });
        }
        *work = done;
        state.attitude = state.attitude.advanced_by(&theta);
        state.origin_global += moved;
        state.time = end;
        std::mem::swap(&mut state.modal_displacement, q);
        std::mem::swap(&mut state.modal_velocity, y);
        self.complete_state(inside);
        Ok(())
    }

    /// Rates at the stage values q, y and the rotation vector since the step's start.
    fn evaluate(&mut self, s: usize, t: f64, inside: f64, theta: &Vector3<f64>) -> Result<(), RateError> {
        let Self { model, motion, cross_products, state, stages, q, y, products, .. } = self;
        let size = q.len();
        let rates = &mut stages[s];
        let global_to_body = transformation_matrix(theta) * state.attitude.global_to_body();
        let omega = motion.angular_rate(&rotation(y));
        let linear = LinearMotion {
            coordinates: Coordinates { first: 0, displacement: q, velocity: y },
            branch_time: inside,
            body_from_global: &global_to_body,
            origin_global: state.origin_global,
            omega_body: omega,
            center_body: motion.of_origin(q),
        };
        rates.work = model.rates(&linear, &[t], &mut rates.velocity);

        add_cross(cross_products, size, &omega, q, products, |i, g| rates.displacement[i] = -g);
        add_cross(cross_products, size, &omega, y, products, |i, g| rates.velocity[i] -= g);
        add(&mut rates.displacement[6..], 1.0, &y[6..]);
        rates.rotation_vector = f_inverse(theta, &omega).map_err(RateError::Turn)?;
        rates.origin = global_to_body.tr_mul(&motion.of_origin(y));
        self.evaluations += 1;
        Ok(())
    }

    /// Accelerations, ω and α of the state: q̈ in the inertial frame that coincides with the body now, and α = ω' in
    /// body axes, which is Euler's. Loads follow the branches of their histories that hold at the time `inside`.
    fn complete_state(&mut self, inside: f64) {
        let Self { model, motion, state, cross_products, products, .. } = self;
        let global_to_body = state.attitude.global_to_body();
        let (q, y) = (&state.modal_displacement, &state.modal_velocity);
        state.omega_body = motion.angular_rate(&rotation(y));
        let linear = LinearMotion {
            coordinates: Coordinates { first: 0, displacement: q, velocity: y },
            branch_time: inside,
            body_from_global: &global_to_body,
            origin_global: state.origin_global,
            omega_body: state.omega_body,
            center_body: motion.of_origin(q),
        };
        model.rates(&linear, &[state.time], &mut state.modal_acceleration);
        let mut turned = Vector3::zeros();
        add_cross(cross_products, y.len(), &state.omega_body, y, products, |i, g| {
            if (3..6).contains(&i) {
                turned[i - 3] = g;
            }
        });
        state.alpha_body = motion.angular_rate(&(rotation(&state.modal_acceleration) - turned));
    }
}

/// The limit of the paper's scheme in the list of schemes.
pub(crate) const METHOD: Method = Method {
    formulation: "paper",
    scheme: "rkmk4",
    order: 4,
    evaluations_per_step: 4,
    limit: StepLimit::Modes,
    estimates_error: false,
    begin: |setup| {
        refuse_beyond_paper(setup.physics)?;
        let model = ModalModel::new(setup.body, setup.damping_ratios, setup.loads.to_vec())?;
        Ok(Box::new(PaperLimit::new(setup.body, model, setup.initial)?))
    },
};

impl Scheme for PaperLimit {
    fn time(&self) -> f64 {
        self.state.time
    }

    fn step(&mut self, h: f64, end: f64) -> Result<(), StepError> {
        let Self { motion, state, work, attitude_account, .. } = self;
        if self.steps_done.is_multiple_of(STEPS_OF_ATTITUDE) {
            motion.check_attitude(state, work, attitude_account, self.longest_step)?;
        }
        self.take_step(h, end)?;
        self.steps_done += 1;
        self.longest_step = self.longest_step.max(h);
        Ok(())
    }

    fn observe(&mut self, points: &[PointShapes], out: &mut Observation) -> Result<(), StepError> {
        self.motion.observe(&self.state, &self.work, points, out);
        Ok(())
    }

    fn state(&self) -> Result<MotionState, StepError> {
        Ok(self.motion.state(&self.state))
    }

    fn set_state(&mut self, state: &MotionState) -> Result<(), SetupError> {
        self.motion.set_state(state, &mut self.state)?;
        self.complete_state(state.time);
        self.attitude_account = AttitudeAccount::default();
        Ok(())
    }

    fn copy_state(&mut self, from: &dyn Scheme) {
        let Some(from) = (from as &dyn Any).downcast_ref::<Self>() else { return };
        self.state.copy_from(&from.state);
        self.work = from.work;
        (self.evaluations, self.steps_done) = (from.evaluations, from.steps_done);
        self.attitude_account = from.attitude_account;
        self.longest_step = from.longest_step;
    }

    fn moment(&self) -> Moment<'_> {
        let State { time, omega_body, modal_displacement, modal_velocity, .. } = &self.state;
        let (q, y) = (&modal_displacement[6..], &modal_velocity[6..]);
        Moment { time: *time, omega_body: *omega_body, modal_displacement: q, modal_velocity: y }
    }

    fn energies(&self) -> Option<Energies> {
        Some(self.motion.energies_of(&self.state, &self.work))
    }

    fn work_and_dissipation(&self) -> [f64; 2] {
        [self.work.work, self.work.dissipation]
    }

    fn fastest_rate(&self) -> f64 {
        self.model.fastest_rate()
    }

    fn evaluations(&self) -> u64 {
        self.evaluations
    }

    fn flexible(&self) -> usize {
        self.state.modal_displacement.len() - 6
    }

    fn save(&self) -> Result<Vec<u8>, CheckpointError> {
        encode(&Saved {
            state: self.state.clone(),
            work: self.work,
            evaluations: self.evaluations,
            steps_done: self.steps_done,
            longest_step: self.longest_step,
            attitude_account: self.attitude_account,
        })
    }

    fn restore(&mut self, saved: &[u8]) -> Result<(), CheckpointError> {
        let Saved { state, work, evaluations, steps_done, longest_step, attitude_account } = decode(saved)?;
        state.check(self.state.modal_displacement.len())?;
        work.check()?;
        counts(&[evaluations, steps_done])?;
        finite("the longest step", [&longest_step])?;
        attitude_account.check_saved()?;
        (self.state, self.work, self.evaluations) = (state, work, evaluations);
        (self.steps_done, self.longest_step, self.attitude_account) = (steps_done, longest_step, attitude_account);
        Ok(())
    }

    fn boxed_clone(&self) -> Box<dyn Scheme> {
        Box::new(self.clone())
    }
}

/// Calls `put(i, (G(ω) x)_i)` for each row i.
fn add_cross(
    stacked: &[f64],
    size: usize,
    omega: &Vector3<f64>,
    x: &[f64],
    products: &mut [f64],
    mut put: impl FnMut(usize, f64),
) {
    crate::column_major::multiply(stacked, 3 * size, x, products);
    for i in 0..size {
        put(i, omega.x * products[i] + omega.y * products[size + i] + omega.z * products[2 * size + i]);
    }
}

fn add(x: &mut [f64], c: f64, rate: &[f64]) {
    for (x, r) in x.iter_mut().zip(rate) {
        *x += c * r;
    }
}
