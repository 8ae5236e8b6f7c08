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

use modal::ReducedBody;
use nalgebra::Vector3;
use rigid_kin::{f_inverse, transformation_matrix};

use crate::account::Reckoning;
use crate::attitude_account::AttitudeAccount;
use crate::checkpoint::Tape;
use crate::error::{RateError, SetupError, StepError};
use crate::initial::Initial;
use crate::model::ModalModel;
use crate::motion::BodyMotion;
use crate::observation::Observation;
use crate::state::{State, rotation};
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
    factors: Vec<f64>,
    q: Vec<f64>,
    y: Vec<f64>,
    products: Vec<f64>,
    evaluations: u64,
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
        let motion = BodyMotion::new(body)?;
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
            factors: vec![0.0; model.loads().len()],
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
        };
        limit.complete_state(0.0);
        Ok(limit)
    }

    /// The state that has been reached.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Evaluations of the rates so far.
    pub fn evaluations(&self) -> u64 {
        self.evaluations
    }

    pub(crate) fn pass(&mut self, tape: &mut Tape) {
        self.state.pass(tape);
        self.work.pass(tape);
        tape.count(&mut self.evaluations);
    }

    /// Does one step of length `h` that ends at time `end`.
    ///
    /// # Errors
    /// [`StepError`]; the state stays that before the step.
    pub fn step(&mut self, h: f64, end: f64) -> Result<(), StepError> {
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

    /// Energies of the state.
    pub(crate) fn reckoning(&self) -> Reckoning {
        self.motion.reckon(&self.state, &self.work)
    }

    /// Work of the loads and dissipation.
    pub(crate) fn done(&self) -> [f64; 2] {
        [self.work.work, self.work.dissipation]
    }

    /// Checks the angular momentum of the state.
    ///
    /// # Errors
    /// [`StepError::Attitude`].
    pub(crate) fn check_attitude(&self, account: &mut AttitudeAccount, step: f64) -> Result<(), StepError> {
        self.motion.check_attitude(&self.state, &self.work, account, step)
    }

    /// Largest of ω_k and 2 ζ_k ω_k.
    pub(crate) fn fastest_rate(&self) -> f64 {
        self.model.fastest_rate()
    }

    /// Fills `out` with the motion at the state, and that of `points`.
    pub fn observe(&self, points: &[crate::motion::PointShapes], out: &mut Observation) {
        self.motion.observe(&self.state, &self.work, points, out);
    }

    /// Rates at the stage values q, y and the rotation vector since the step's start.
    fn evaluate(&mut self, s: usize, t: f64, inside: f64, theta: &Vector3<f64>) -> Result<(), RateError> {
        let Self { model, motion, cross_products, state, stages, q, y, products, factors, .. } = self;
        let size = q.len();
        let rates = &mut stages[s];
        let global_to_body = transformation_matrix(theta) * state.attitude.global_to_body();
        let omega = motion.angular_rate(&rotation(y));
        model.factors_at(t, inside, factors);
        model.acceleration(q, y, factors, &global_to_body, &mut rates.velocity);
        rates.work = model.power(q, y, factors, &global_to_body, &motion.of_origin(q));

        add_cross(cross_products, size, &omega, q, products, |i, g| rates.displacement[i] = -g);
        add_cross(cross_products, size, &omega, y, products, |i, g| rates.velocity[i] -= g);
        add(&mut rates.displacement[6..], 1.0, &y[6..]);
        rates.rotation_vector = f_inverse(theta, &omega).map_err(RateError::Turn)?;
        rates.origin = global_to_body.tr_mul(&motion.of_origin(y));
        self.evaluations += 1;
        Ok(())
    }

    /// Accelerations, ω and α of the state: q̈ in the inertial frame that coincides with the body now, and α = ω' in
    /// body axes, which is Euler's. Loads follow the laws that hold at the time `inside`.
    fn complete_state(&mut self, inside: f64) {
        let Self { model, motion, state, factors, cross_products, products, .. } = self;
        let global_to_body = state.attitude.global_to_body();
        let (q, y) = (&state.modal_displacement, &state.modal_velocity);
        model.factors_at(state.time, inside, factors);
        model.acceleration(q, y, factors, &global_to_body, &mut state.modal_acceleration);
        state.omega_body = motion.angular_rate(&rotation(y));
        let mut turned = Vector3::zeros();
        add_cross(cross_products, y.len(), &state.omega_body, y, products, |i, g| {
            if (3..6).contains(&i) {
                turned[i - 3] = g;
            }
        });
        state.alpha_body = motion.angular_rate(&(rotation(&state.modal_acceleration) - turned));
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
    crate::conservative::multiply(stacked, 3 * size, x, products);
    for i in 0..size {
        put(i, omega.x * products[i] + omega.y * products[size + i] + omega.z * products[2 * size + i]);
    }
}

fn add(x: &mut [f64], c: f64, rate: &[f64]) {
    for (x, r) in x.iter_mut().zip(rate) {
        *x += c * r;
    }
}
