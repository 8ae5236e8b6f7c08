//! The paper's scheme, Eqs. (36) to (40), in modal space.
//!
//! It does what the paper says, its properties included (first order; spin that grows or fades at the relative rate
//! ω²Δt/2; stable to Δt·ω_max = 2.83). Two things the paper leaves open are settled as `docs/method/paper.md` tells:
//! each step's rotation vector starts at zero, since (22) is singular after one turn, and a stage takes the loads'
//! components in the stage's own frame.

use dynamics::nalgebra::{Matrix3, Vector3};
use dynamics::reduced_body::ReducedBody;
use dynamics::rigid_kin::{BeyondFullTurn, ReferencePoints, f_inverse, relative_velocity_rate, transformation_matrix};
use dynamics::{Abilities, Begin, Beginning, Initial, Key, Method, Setup, SetupError, StepError, StepLimit, Work};

use crate::modal_rotation::ModalRotation;
use crate::model::{LinearMotion, ModalModel};
use crate::state::State;
use crate::travelling_frame::{
    Carried, EVALUATIONS, FORMULATION, FrameMotion, FrameSteps, TravellingFrame, turn_error,
};

/// Steps a flexible body by the paper's scheme.
pub type PaperScheme = TravellingFrame<PaperSteps>;

/// The steps of the paper.
#[derive(Debug, Clone)]
pub struct PaperSteps {
    rotation: ModalRotation,
    kinematics: ReferenceKinematics,
    /// Power of the loads and the damping at the state.
    power: Work,
    /// True if a load may jump where the state is, so that its accelerations are to be found again.
    at_discontinuity: bool,
    scratch: Scratch,
}

/// Relative motion of P and Q in the rigid modes.
#[derive(Debug, Clone)]
struct ReferenceKinematics {
    points: ReferencePoints,
    rotation_basis: Matrix3<f64>,
    /// P − R and Q − R.
    arms: [Vector3<f64>; 2],
}

/// Velocities of P and Q relative to R, body components.
type Relative = [Vector3<f64>; 2];

/// One stage's increments: Δη, ΔM and Δv.
#[derive(Debug, Clone)]
struct Increment {
    displacement: Vec<f64>,
    velocity: Vec<f64>,
    rotation_vector: Vector3<f64>,
    relative_velocity: Relative,
}

#[derive(Debug, Clone)]
struct Scratch {
    stage: Increment,
    total: Increment,
    /// Argument of T.
    unrotated: Vec<f64>,
    next_displacement: Vec<f64>,
    next_velocity: Vec<f64>,
    acceleration: Vec<f64>,
}

impl PaperScheme {
    /// A motion of `body` from `initial`. `reference_points` are R, P, Q from the centre of mass, body axes.
    ///
    /// # Errors
    /// [`SetupError`]: lists of wrong length, numbers that are not finite, reference points on a line.
    pub fn new(
        body: &ReducedBody,
        model: ModalModel,
        reference_points: [Vector3<f64>; 3],
        initial: &Initial,
    ) -> Result<Self, SetupError> {
        let [r, p, q] = reference_points;
        let kinematics = ReferenceKinematics {
            points: ReferencePoints::new(&r, &p, &q)?,
            rotation_basis: body.rotation_basis,
            arms: [p - r, q - r],
        };
        let zeros = || vec![0.0; 6 + body.flexible()];
        let increment = || Increment {
            displacement: zeros(),
            velocity: zeros(),
            rotation_vector: Vector3::zeros(),
            relative_velocity: [Vector3::zeros(); 2],
        };
        let steps = PaperSteps {
            rotation: ModalRotation::new(body),
            kinematics,
            power: Work::default(),
            at_discontinuity: true,
            scratch: Scratch {
                stage: increment(),
                total: increment(),
                unrotated: zeros(),
                next_displacement: zeros(),
                next_velocity: zeros(),
                acceleration: zeros(),
            },
        };
        Self::begin(body, model, initial, steps)
    }
}

impl FrameSteps for PaperSteps {
    /// Does one step, k1 to k4 and (38) to (40).
    fn step(&mut self, body: &mut FrameMotion, h: f64, end: f64) -> Result<(), StepError> {
        let time = body.state.time;
        let branch_time = time + 0.5 * h;
        if self.at_discontinuity {
            self.complete_state(body, branch_time);
            self.at_discontinuity = false;
        }
        let Self { rotation, kinematics, scratch, .. } = self;
        let FrameMotion { model, motion, state, work } = body;
        let global_to_body = state.attitude.global_to_body();
        let relative_velocity = kinematics.relative(&state.modal_velocity);
        let turn_error = |error: BeyondFullTurn| turn_error(&error, time, h);
        scratch.total.clear();

        // k1: in the frame of the step's start, where θ = 0 and f⁻¹ is the identity.
        let Scratch { stage, total, unrotated, next_displacement, next_velocity, acceleration } = scratch;
        stage.set_modal(h, &state.modal_velocity, &state.modal_acceleration);
        stage.relative_velocity =
            kinematics.relative_velocity_change(h, &state.modal_acceleration, &relative_velocity, &state.omega_body);
        stage.rotation_vector = h * state.omega_body;
        total.add(1.0 / 6.0, stage);

        // k2 and k3 take the mean of the loads at both ends of the step, k4 those at its end.
        let (both_ends, at_end) = ([time, end], [end]);
        for (fraction, weight, load_times) in
            [(0.5, 1.0 / 3.0, &both_ends[..]), (0.5, 1.0 / 3.0, &both_ends), (1.0, 1.0 / 6.0, &at_end)]
        {
            let v: Relative = std::array::from_fn(|i| relative_velocity[i] + fraction * stage.relative_velocity[i]);
            let omega = kinematics.points.angular_velocity(&v[0], &v[1]);
            let theta = fraction * stage.rotation_vector;
            let turn = transformation_matrix(&theta);
            rotation.set(&turn);
            advance(rotation, state, fraction, stage, unrotated, next_displacement, next_velocity);
            let linear = LinearMotion {
                displacement: next_displacement,
                velocity: next_velocity,
                branch_time,
                body_from_global: &(turn * global_to_body),
                origin_global: state.origin_global,
                omega_body: omega,
                motion,
            };
            model.rates(&linear, load_times, acceleration);

            stage.set_modal(h, next_velocity, acceleration);
            stage.relative_velocity = kinematics.relative_velocity_change(h, acceleration, &v, &omega);
            stage.rotation_vector = h * f_inverse(&theta, &omega).map_err(turn_error)?;
            total.add(weight, stage);
        }

        let theta = total.rotation_vector; // (38), (39) are the weights above
        let angle = theta.norm();
        if angle.is_nan() || angle >= std::f64::consts::TAU {
            return Err(turn_error(BeyondFullTurn { angle }));
        }
        rotation.set(&transformation_matrix(&theta));
        advance(rotation, state, 1.0, total, unrotated, next_displacement, next_velocity); // (40)
        if !next_displacement.iter().chain(next_velocity.iter()).all(|x| x.is_finite()) {
            return Err(StepError::NotFinite { time, what: "a modal coordinate" });
        }

        // The rigid displacement that (40) takes out is where the frame goes.
        let moved_body = motion.of_origin(&total.displacement);
        state.origin_global += state.attitude.to_global(&moved_body);
        state.attitude = state.attitude.advanced_by(&theta);
        std::mem::swap(&mut state.modal_displacement, next_displacement);
        std::mem::swap(&mut state.modal_velocity, next_velocity);
        state.time = end;
        // By the trapezoidal rule: far closer than a first-order scheme closes its balances.
        work.add(0.5 * h, &self.power);
        self.complete_state(body, branch_time);
        body.work.add(0.5 * h, &self.power);
        Ok(())
    }

    /// Accelerations (35), ω (36) and α (37) of the state's displacements and velocities, and the power of the loads.
    /// Loads follow the branches of their histories that hold at `branch_time`.
    fn complete_state(&mut self, body: &mut FrameMotion, branch_time: f64) {
        let kinematics = &self.kinematics;
        let FrameMotion { model, motion, state, .. } = body;
        let global_to_body = state.attitude.global_to_body();
        let [v_p, v_q] = kinematics.relative(&state.modal_velocity);
        state.omega_body = kinematics.points.angular_velocity(&v_p, &v_q);
        let linear = LinearMotion {
            displacement: &state.modal_displacement,
            velocity: &state.modal_velocity,
            branch_time,
            body_from_global: &global_to_body,
            origin_global: state.origin_global,
            omega_body: state.omega_body,
            motion,
        };
        self.power = model.rates(&linear, &[state.time], &mut state.modal_acceleration);
        let [a_p, a_q] = kinematics.relative(&state.modal_acceleration);
        state.alpha_body = kinematics.points.angular_acceleration(&v_p, &v_q, &a_p, &a_q, &state.omega_body);
    }

    fn pass_discontinuity(&mut self) {
        self.at_discontinuity = true;
    }

    fn carried(&self) -> Carried {
        Carried { power: self.power, at_discontinuity: self.at_discontinuity }
    }

    fn carry_on(&mut self, carried: Carried) {
        (self.power, self.at_discontinuity) = (carried.power, carried.at_discontinuity);
    }
}

/// The paper's scheme, literally, with reference points at the origin and at unit distances along x and y; see [`Paper`].
pub const PAPER: Method = Method {
    formulation: FORMULATION,
    scheme: "paper",
    order: 1,
    evaluations_per_step: EVALUATIONS,
    limit: StepLimit::Modes,
    estimates_error: false,
    abilities: Abilities::NONE,
    joints: None,
    begin: |setup| Paper { reference_points: [Vector3::zeros(), Vector3::x(), Vector3::y()] }.begin(setup),
};

/// [`PAPER`] with other reference points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Paper {
    /// R, P, Q from the body's origin, body axes; not on a line.
    pub reference_points: [Vector3<f64>; 3],
}

impl Paper {
    /// This for [`PAPER`], and any other method as it is.
    pub fn or<'a>(&'a self, method: &'a Method) -> &'a dyn Begin {
        if *method == PAPER { self } else { method }
    }
}

impl Begin for Paper {
    fn method(&self) -> Method {
        PAPER
    }

    fn begin(&self, setup: &Setup) -> Result<Beginning, SetupError> {
        let model = ModalModel::new(setup.body, setup.damping_ratios, setup.loads.to_vec())?;
        let scheme = PaperScheme::new(setup.body, model, self.reference_points, setup.initial)?;
        Ok(Beginning { motion: Box::new(scheme), energy_of_loads: setup.energy_of_loads()? })
    }

    fn key(&self, key: Key) -> Key {
        PAPER.key(key).with("reference points", self.reference_points.as_slice())
    }
}

impl ReferenceKinematics {
    /// Velocities (or accelerations) of P and Q relative to R in the rigid modes: `(B y) × arm`.
    fn relative(&self, modal: &[f64]) -> Relative {
        let rate = self.rotation_basis * crate::state::rotation(modal);
        self.arms.map(|arm| rate.cross(&arm))
    }

    /// Δv of (15) and (16) over a step of length h.
    fn relative_velocity_change(
        &self,
        h: f64,
        modal_acceleration: &[f64],
        velocity: &Relative,
        omega: &Vector3<f64>,
    ) -> Relative {
        let acceleration = self.relative(modal_acceleration);
        std::array::from_fn(|i| h * relative_velocity_rate(&acceleration[i], &velocity[i], omega))
    }
}

impl Increment {
    fn clear(&mut self) {
        self.displacement.fill(0.0);
        self.velocity.fill(0.0);
        self.rotation_vector = Vector3::zeros();
    }

    /// Δη = Δt η̇
    fn set_modal(&mut self, h: f64, velocity: &[f64], acceleration: &[f64]) {
        for (increment, rate) in [(&mut self.displacement, velocity), (&mut self.velocity, acceleration)] {
            for (d, r) in increment.iter_mut().zip(rate) {
                *d = h * r;
            }
        }
    }

    fn add(&mut self, weight: f64, stage: &Self) {
        for (sum, part) in [(&mut self.displacement, &stage.displacement), (&mut self.velocity, &stage.velocity)] {
            for (s, p) in sum.iter_mut().zip(part) {
                *s += weight * p;
            }
        }
        self.rotation_vector += weight * stage.rotation_vector;
    }
}

/// `T({x, ẋ}_n + fraction·Ψ Δη − {fraction·Ψ_R Δq_R, 0})` and its inverse modal expansion: the rigid displacements of
/// the increment stay with the frame.
fn advance(
    rotation: &ModalRotation,
    state: &State,
    fraction: f64,
    increment: &Increment,
    unrotated: &mut [f64],
    displacement: &mut [f64],
    velocity: &mut [f64],
) {
    for (x, (q, dq)) in unrotated.iter_mut().zip(state.modal_displacement.iter().zip(&increment.displacement)) {
        *x = q + fraction * dq;
    }
    unrotated[..6].copy_from_slice(&state.modal_displacement[..6]);
    rotation.apply(unrotated, displacement);
    for (x, (y, dy)) in unrotated.iter_mut().zip(state.modal_velocity.iter().zip(&increment.velocity)) {
        *x = y + fraction * dy;
    }
    rotation.apply(unrotated, velocity);
}
