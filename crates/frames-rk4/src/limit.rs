//! The paper's physics at fourth order: one consistent frame per step, Runge–Kutta–Munthe-Kaas. Eq. (P2) of `docs/method/paper.md`.
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

use dynamics::faer::Mat;
use dynamics::nalgebra::Vector3;
use dynamics::reduced_body::ReducedBody;
use dynamics::rigid_kin::{BeyondFullTurn, f_inverse, transformation_matrix};
use dynamics::{Abilities, Beginning, Initial, Method, SetupError, StepError, StepLimit, Work};

use crate::cross_products::{cross_products, multiply};
use crate::model::{LinearMotion, ModalModel};
use crate::state::rotation;
use crate::travelling_frame::{EVALUATIONS, FORMULATION, FrameMotion, FrameSteps, TravellingFrame, turn_error};

/// Steps the limit of the paper's scheme by RKMK4.
pub type PaperLimit = TravellingFrame<LimitSteps>;

/// The steps of RKMK4.
#[derive(Debug, Clone)]
pub struct LimitSteps {
    /// G_1, G_2, G_3 of all modes, one below another (3 (6+nf) × (6+nf)).
    cross_products: Mat<f64>,
    stages: [Rates; 4],
    q: Vec<f64>,
    y: Vec<f64>,
    products: Vec<f64>,
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
        let size = 6 + body.flexible();
        let [g_1, g_2, g_3] = cross_products(body);
        let cross_products = dynamics::faer::concat![[g_1], [g_2], [g_3]];
        let zeros = || vec![0.0; size];
        let rates = Rates {
            rotation_vector: Vector3::zeros(),
            origin: Vector3::zeros(),
            work: Work::default(),
            displacement: zeros(),
            velocity: zeros(),
        };
        let steps = LimitSteps {
            cross_products,
            stages: std::array::from_fn(|_| rates.clone()),
            q: zeros(),
            y: zeros(),
            products: vec![0.0; 3 * size],
        };
        Self::begin(body, model, initial, steps)
    }
}

impl FrameSteps for LimitSteps {
    /// Does one step of classical Runge–Kutta.
    fn step(&mut self, body: &mut FrameMotion, h: f64, end: f64) -> Result<(), StepError> {
        let time = body.state.time;
        let branch_time = time + 0.5 * h;
        for (s, fraction) in [0.0, 0.5, 0.5, 1.0].into_iter().enumerate() {
            let c = fraction * h;
            let mut theta = Vector3::zeros();
            self.q.copy_from_slice(&body.state.modal_displacement);
            self.y.copy_from_slice(&body.state.modal_velocity);
            if s > 0 {
                let before = &self.stages[s - 1];
                theta = before.rotation_vector * c;
                add(&mut self.q, c, &before.displacement);
                add(&mut self.y, c, &before.velocity);
            }
            self.evaluate(body, s, time + c, branch_time, &theta).map_err(|error| turn_error(&error, time, h))?;
        }
        let Self { stages, q, y, .. } = self;
        let FrameMotion { state, work, .. } = body;
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
        self.complete_state(body, branch_time);
        Ok(())
    }

    /// Accelerations, ω and α of the state: q̈ in the inertial frame that coincides with the body now, and α = ω' in
    /// body axes, which is Euler's. Loads follow the branches of their histories that hold at `branch_time`.
    fn complete_state(&mut self, body: &mut FrameMotion, branch_time: f64) {
        let Self { cross_products, products, .. } = self;
        let FrameMotion { model, motion, state, .. } = body;
        let global_to_body = state.attitude.global_to_body();
        let (q, y) = (&state.modal_displacement, &state.modal_velocity);
        state.omega_body = motion.angular_rate(&rotation(y));
        let linear = LinearMotion {
            displacement: q,
            velocity: y,
            branch_time,
            body_from_global: &global_to_body,
            origin_global: state.origin_global,
            omega_body: state.omega_body,
            motion,
        };
        model.rates(&linear, &[state.time], &mut state.modal_acceleration);
        let mut turned = Vector3::zeros();
        add_cross(cross_products, &state.omega_body, y, products, |i, g| {
            if (3..6).contains(&i) {
                turned[i - 3] = g;
            }
        });
        state.alpha_body = motion.angular_rate(&(rotation(&state.modal_acceleration) - turned));
    }
}

impl LimitSteps {
    /// Rates at the stage values q, y and the rotation vector since the step's start.
    fn evaluate(
        &mut self,
        body: &FrameMotion,
        s: usize,
        t: f64,
        branch_time: f64,
        theta: &Vector3<f64>,
    ) -> Result<(), BeyondFullTurn> {
        let Self { cross_products, stages, q, y, products } = self;
        let FrameMotion { model, motion, state, .. } = body;
        let rates = &mut stages[s];
        let global_to_body = transformation_matrix(theta) * state.attitude.global_to_body();
        let omega = motion.angular_rate(&rotation(y));
        let linear = LinearMotion {
            displacement: q,
            velocity: y,
            branch_time,
            body_from_global: &global_to_body,
            origin_global: state.origin_global,
            omega_body: omega,
            motion,
        };
        rates.work = model.rates(&linear, &[t], &mut rates.velocity);

        add_cross(cross_products, &omega, q, products, |i, g| rates.displacement[i] = -g);
        add_cross(cross_products, &omega, y, products, |i, g| rates.velocity[i] -= g);
        add(&mut rates.displacement[6..], 1.0, &y[6..]);
        rates.rotation_vector = f_inverse(theta, &omega)?;
        rates.origin = global_to_body.tr_mul(&motion.of_origin(y));
        Ok(())
    }
}

/// The limit of the paper's scheme, by RKMK4.
pub const LIMIT: Method = Method {
    formulation: FORMULATION,
    scheme: "rkmk4",
    order: 4,
    evaluations_per_step: EVALUATIONS,
    limit: StepLimit::Modes,
    estimates_error: false,
    abilities: Abilities::NONE,
    joints: None,
    begin: |setup| {
        let model = ModalModel::new(setup.body, setup.damping_ratios, setup.loads.to_vec())?;
        let scheme = PaperLimit::new(setup.body, model, setup.initial)?;
        Ok(Beginning { motion: Box::new(scheme), energy_of_loads: setup.energy_of_loads()? })
    },
};

/// Calls `put(i, (G(ω) x)_i)` for each row i.
fn add_cross(
    stacked: &Mat<f64>,
    omega: &Vector3<f64>,
    x: &[f64],
    products: &mut [f64],
    mut put: impl FnMut(usize, f64),
) {
    let size = x.len();
    multiply(stacked, x, products);
    for i in 0..size {
        put(i, omega.x * products[i] + omega.y * products[size + i] + omega.z * products[2 * size + i]);
    }
}

fn add(x: &mut [f64], c: f64, rate: &[f64]) {
    for (x, r) in x.iter_mut().zip(rate) {
        *x += c * r;
    }
}
