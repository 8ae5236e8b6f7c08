//! The paper's scheme, Eqs. (36) to (40), in modal space.
//!
//! It does what the paper says, its properties included (first order; spin that grows or fades at the relative rate
//! ω²Δt/2; stable to Δt·ω_max = 2.83). Two things the paper leaves open are settled as `docs/method.md` tells:
//! each step's rotation vector starts at zero, since (22) is singular after one turn, and a stage takes the loads'
//! components in the stage's own frame.

use modal::ReducedBody;
use nalgebra::{Matrix3, Vector3};
use rigid_kin::{BeyondFullTurn, ReferencePoints, f_inverse, relative_velocity_rate, transformation_matrix};

use crate::account::Reckoning;
use crate::attitude_account::AttitudeAccount;
use crate::checkpoint::Tape;
use crate::error::{RateError, SetupError, StepError};
use crate::initial::Initial;
use crate::modal_rotation::ModalRotation;
use crate::model::ModalModel;
use crate::motion::{BodyMotion, PointShapes};
use crate::observation::Observation;
use crate::state::State;
use crate::work::Work;

/// Steps a flexible body by the paper's scheme.
///
/// As an iterator it yields the state after each step, without end; [`PaperScheme::step`] does the same without
/// allocating.
#[derive(Debug, Clone)]
pub struct PaperScheme {
    model: ModalModel,
    rotation: ModalRotation,
    kinematics: ReferenceKinematics,
    motion: BodyMotion,
    step: f64,
    steps_done: u64,
    state: State,
    work: Work,
    power: Work,
    forces: StepForces,
    scratch: Scratch,
    failed: bool,
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

/// Factors of the loads at the start and the end of a step, and their mean.
#[derive(Debug, Clone)]
struct StepForces {
    start: Vec<f64>,
    mean: Vec<f64>,
    end: Vec<f64>,
}

#[derive(Debug, Clone)]
struct Scratch {
    stage: Increment,
    total: Increment,
    /// What T is applied to.
    unrotated: Vec<f64>,
    next_displacement: Vec<f64>,
    next_velocity: Vec<f64>,
    acceleration: Vec<f64>,
}

impl PaperScheme {
    /// A motion of `body` from `initial` in steps of `step`. `reference_points` are R, P, Q from the centre of mass,
    /// body axes.
    ///
    /// # Errors
    /// [`SetupError`]: lists of wrong length, numbers that are not finite, a step beyond the stability limit.
    pub fn new(
        body: &ReducedBody,
        model: ModalModel,
        reference_points: [Vector3<f64>; 3],
        initial: &Initial,
        step: f64,
    ) -> Result<Self, SetupError> {
        model.check_body(body)?;
        model.check_step(step)?;
        let [r, p, q] = reference_points;
        let kinematics = ReferenceKinematics {
            points: ReferencePoints::new(&r, &p, &q)?,
            rotation_basis: body.rotation_basis,
            arms: [p - r, q - r],
        };
        let state = State::begin(body, initial)?;
        let zeros = || vec![0.0; state.modal_displacement.len()];
        let forces = || vec![0.0; model.loads().len()];
        let increment = || Increment {
            displacement: zeros(),
            velocity: zeros(),
            rotation_vector: Vector3::zeros(),
            relative_velocity: [Vector3::zeros(); 2],
        };
        let mut scheme = Self {
            rotation: ModalRotation::new(body),
            kinematics,
            motion: BodyMotion::new(body)?,
            step,
            steps_done: 0,
            work: Work::default(),
            power: Work::default(),
            forces: StepForces { start: forces(), mean: forces(), end: forces() },
            scratch: Scratch {
                stage: increment(),
                total: increment(),
                unrotated: zeros(),
                next_displacement: zeros(),
                next_velocity: zeros(),
                acceleration: zeros(),
            },
            failed: false,
            state,
            model,
        };
        scheme.complete_state(0.0);
        Ok(scheme)
    }

    /// The state that has been reached.
    pub fn state(&self) -> &State {
        &self.state
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
    pub fn observe(&self, points: &[PointShapes], out: &mut Observation) {
        self.motion.observe(&self.state, &self.work, points, out);
    }

    /// Evaluations of (35) so far: four for each step.
    pub fn evaluations(&self) -> u64 {
        4 * self.steps_done
    }

    /// Does one step of the length given at the beginning, k1 to k4 and (38) to (40).
    ///
    /// # Errors
    /// [`StepError`]; the state stays that before the step.
    pub fn step(&mut self) -> Result<&State, StepError> {
        self.take_step(self.step, (self.steps_done + 1) as f64 * self.step)?;
        Ok(&self.state)
    }

    pub(crate) fn pass(&mut self, tape: &mut Tape) {
        self.state.pass(tape);
        self.work.pass(tape);
        self.power.pass(tape);
        tape.numbers(&mut self.forces.start);
        tape.count(&mut self.steps_done);
    }

    /// Does one step of length `h` that ends at time `end`.
    ///
    /// # Errors
    /// [`StepError`]; the state stays that before the step.
    pub fn take_step(&mut self, h: f64, end: f64) -> Result<(), StepError> {
        let time = self.state.time;
        let inside = time + 0.5 * h;
        self.model.factors_at(time, inside, &mut self.forces.mean);
        if self.forces.mean != self.forces.start {
            // A load jumps here.
            self.complete_state(inside);
        }
        let Self { model, rotation, kinematics, state, scratch, forces, .. } = self;
        model.factors_at(end, inside, &mut forces.end);
        for (mean, (start, end)) in forces.mean.iter_mut().zip(forces.start.iter().zip(&forces.end)) {
            *mean = 0.5 * (start + end);
        }
        let global_to_body = state.attitude.global_to_body();
        let relative_velocity = kinematics.relative(&state.modal_velocity);
        let turn_error = |error: BeyondFullTurn| RateError::Turn(error).in_step(time, h);
        scratch.total.clear();

        // k1: in the frame of the step's start, where θ = 0 and f⁻¹ is the identity.
        let Scratch { stage, total, unrotated, next_displacement, next_velocity, acceleration } = scratch;
        stage.set_modal(h, &state.modal_velocity, &state.modal_acceleration);
        stage.relative_velocity =
            kinematics.relative_velocity_change(h, &state.modal_acceleration, &relative_velocity, &state.omega_body);
        stage.rotation_vector = h * state.omega_body;
        total.add(1.0 / 6.0, stage);

        for (fraction, weight, forces) in [
            (0.5, 1.0 / 3.0, &forces.mean), // k2
            (0.5, 1.0 / 3.0, &forces.mean), // k3
            (1.0, 1.0 / 6.0, &forces.end),  // k4
        ] {
            let v: Relative = std::array::from_fn(|i| relative_velocity[i] + fraction * stage.relative_velocity[i]);
            let omega = kinematics.points.angular_velocity(&v[0], &v[1]);
            let theta = fraction * stage.rotation_vector;
            let turn = transformation_matrix(&theta);
            rotation.set(&turn);
            advance(rotation, state, fraction, stage, unrotated, next_displacement, next_velocity);
            model.acceleration(next_displacement, next_velocity, forces, &(turn * global_to_body), acceleration);

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
        let moved_body = self.motion.of_origin(&total.displacement);
        state.origin_global += state.attitude.to_global(&moved_body);
        state.attitude = state.attitude.advanced_by(&theta);
        std::mem::swap(&mut state.modal_displacement, next_displacement);
        std::mem::swap(&mut state.modal_velocity, next_velocity);
        self.steps_done += 1;
        state.time = end;
        self.work.add(0.5 * h, &self.power);
        self.complete_state(inside);
        // By the trapezoidal rule: far closer than a first-order scheme closes its balances.
        self.work.add(0.5 * h, &self.power);
        Ok(())
    }

    /// Accelerations (35), ω (36) and α (37) of the state's displacements and velocities, and the power of the loads.
    /// Loads follow the laws that hold at the time `inside`.
    fn complete_state(&mut self, inside: f64) {
        let Self { model, kinematics, state, forces, .. } = self;
        model.factors_at(state.time, inside, &mut forces.start);
        let global_to_body = state.attitude.global_to_body();
        let (q, y) = (&state.modal_displacement, &state.modal_velocity);
        model.acceleration(q, y, &forces.start, &global_to_body, &mut state.modal_acceleration);
        let center = self.motion.of_origin(q);
        self.power = model.power(q, y, &forces.start, &global_to_body, &center);
        let [v_p, v_q] = kinematics.relative(&state.modal_velocity);
        let [a_p, a_q] = kinematics.relative(&state.modal_acceleration);
        state.omega_body = kinematics.points.angular_velocity(&v_p, &v_q);
        state.alpha_body = kinematics.points.angular_acceleration(&v_p, &v_q, &a_p, &a_q, &state.omega_body);
    }
}

impl Iterator for PaperScheme {
    type Item = Result<State, StepError>;

    /// The state after the next step; `None` after an error.
    fn next(&mut self) -> Option<Self::Item> {
        if self.failed {
            return None;
        }
        let result = self.step().cloned();
        self.failed = result.is_err();
        Some(result)
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
