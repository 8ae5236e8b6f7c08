//! The rates of a state.

use nalgebra::{Matrix3, Vector3};
use pulp::{Arch, Simd, WithSimd};
use rigid_kin::{f_inverse, transformation_matrix};

use crate::conservative::body::{ConservativeBody, Translation, along};
use crate::conservative::evaluation::Evaluation;
use crate::conservative::state::{ConservativeState, Slow, get, part, set};
use crate::error::{RateError, StepError};
use crate::load::{Applied, Coordinates, Kinematics};
use crate::matrix::column_major::dot;

/// Rates of a [`ConservativeState`].
#[derive(Debug, Clone, PartialEq)]
pub struct ConservativeRates {
    /// Angular velocity of the body frame, body components: the attitude turns with it.
    pub omega_body: Vector3<f64>,
    /// Rate of the position of the origin, global components.
    pub velocity_global: Vector3<f64>,
    /// Rate of the linear momentum, global components.
    pub force_global: Vector3<f64>,
    /// Rate of the angular momentum π, one component for each axis that the body turns about.
    pub moment_body: Vector3<f64>,
    /// q̇ (nf).
    pub modal_velocity: Vec<f64>,
    /// p' (nf).
    pub modal_force: Vec<f64>,
}

/// The rates of a state, in the widest vectors that the processor has.
struct Rates<'a> {
    body: &'a ConservativeBody,
    times: [f64; 2],
    first_attitude: &'a Matrix3<f64>,
    slow: &'a Slow,
    e: &'a mut Evaluation,
}

impl WithSimd for Rates<'_> {
    type Output = Result<(), RateError>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self { body, times, first_attitude, slow, e } = self;
        body.find_rates(simd, times, first_attitude, slow, e)
    }
}

impl ConservativeBody {
    /// Rates of a state, for an integrator of one's own. Laws with branches are taken as they are at `branch_time`.
    ///
    /// # Errors
    /// [`StepError`] where the inertia of the deformed body is singular.
    pub fn rates(&self, state: &ConservativeState, branch_time: f64) -> Result<ConservativeRates, StepError> {
        let mut e = self.evaluation();
        self.evaluate_at(state, branch_time, &mut e).map_err(|error| error.in_step(state.time, 0.0))?;
        self.add_linear(&mut e);
        Ok(ConservativeRates {
            omega_body: e.omega_body,
            velocity_global: get(&e.slow, part::POSITION),
            force_global: get(&e.slow, part::MOMENTUM),
            moment_body: get(&e.slow, part::PI),
            modal_velocity: e.displacement.to_vec(),
            modal_force: e.momentum.to_vec(),
        })
    }

    /// All rates at time `t` and the q and p of `e`, with the rotation vector counted from the attitude of which this is the
    /// transformation matrix. Loads and drives follow the branches of their histories that hold at `branch_time`.
    pub(crate) fn evaluate(
        &self,
        times: [f64; 2],
        first_attitude: &Matrix3<f64>,
        slow: &Slow,
        e: &mut Evaluation,
    ) -> Result<(), RateError> {
        Arch::new().dispatch(Rates { body: self, times, first_attitude, slow, e })
    }

    /// All rates of a state.
    pub(crate) fn evaluate_at(
        &self,
        state: &ConservativeState,
        branch_time: f64,
        e: &mut Evaluation,
    ) -> Result<(), RateError> {
        e.q.copy_from_slice(&state.modal_displacement);
        e.p.copy_from_slice(&state.modal_momentum);
        self.evaluate([state.time, branch_time], &state.attitude.global_to_body(), &state.slow, e)
    }

    #[inline(always)]
    fn find_rates<S: Simd>(
        &self,
        simd: S,
        [t, branch_time]: [f64; 2],
        first_attitude: &Matrix3<f64>,
        slow: &Slow,
        e: &mut Evaluation,
    ) -> Result<(), RateError> {
        self.deform(simd, e);
        let (mut speed, mut driven_acceleration) = (0.0, 0.0);
        if let Some(drive) = &self.drive {
            (speed, driven_acceleration) = (drive.speed_at(t, branch_time), drive.acceleration_at(t, branch_time));
        }
        e.driven_speed = speed;
        self.start_velocities(speed, e);
        let pi = get(slow, part::PI);
        if self.turn_driven {
            e.spin = Vector3::new(speed, 0.0, 0.0);
        } else if !self.axes.is_empty() {
            let mut right = pi;
            if self.manifold.is_some() {
                for (i, s) in e.forward_s.iter().enumerate() {
                    right[i] -= dot(s, &e.modal_velocity);
                }
            } else if self.locked {
                right -= e.s_by_momentum;
            } else {
                right -= self.s_products(simd, &e.products, e.p.groups());
            }
            e.spin = self.solve_locked(e, &right)?;
        }
        let w = e.spin;
        e.omega_body = self.axis_columns * w;
        let dissipation = self.find_velocities(simd, speed, e);

        let momentum = get(slow, part::MOMENTUM);
        let velocity = match self.translation {
            Translation::None => Vector3::zeros(),
            Translation::Free | Translation::Along(_) => momentum / self.mass,
            Translation::Driven(direction) => first_attitude.tr_mul(&direction) * speed,
        };
        let theta = get(slow, part::THETA);
        let turning = !self.axes.is_empty();
        let theta_rate =
            if turning { f_inverse(&theta, &e.omega_body).map_err(RateError::Turn)? } else { Vector3::zeros() };
        self.inertia_forces(simd, e);
        let mut pi_rate = if self.axes.len() == 3 { pi.cross(&w) } else { Vector3::zeros() };
        let mut power = 0.0;
        let (mut force, mut angular_impulse) = (Vector3::zeros(), Vector3::zeros());
        if !self.loads.is_empty() {
            let body_from_global =
                if turning { transformation_matrix(&theta) * first_attitude } else { *first_attitude };
            self.find_in_shapes(e);
            let omega_body = e.omega_body;
            let Evaluation { q, modal_velocity, in_shapes: [xi, nu, _], force_in_shapes, momentum, .. } = &mut *e;
            let (coordinates, mut applied);
            let (first, on_manifold) = (6, Some([&**q, &**modal_velocity]));
            if self.manifold.is_some() {
                force_in_shapes.fill(0.0);
                coordinates = Coordinates { first, displacement: xi, velocity: nu, on_manifold };
                applied = Applied::new(coordinates, Vector3::zeros(), force_in_shapes).on_manifold(momentum);
            } else {
                coordinates = Coordinates { first, displacement: q, velocity: modal_velocity, on_manifold: None };
                applied = Applied::new(coordinates, Vector3::zeros(), momentum);
            }
            let motion = Kinematics {
                time: t,
                branch_time,
                body_from_global: &body_from_global,
                origin_global: get(slow, part::POSITION),
                frame_origin_global: get(slow, part::POSITION),
                origin_velocity_global: velocity,
                omega_body,
                coordinates,
                unit: false,
            };
            self.loads.iter().for_each(|load| load.apply(&motion, &mut applied));
            let Applied { force_body, moment_body: moment, modal_power, .. } = applied;
            (e.load_force, e.load_moment) = (force_body, moment);
            power = modal_power + moment.dot(&omega_body);
            force = body_from_global.tr_mul(&force_body);
            let components = self.axis_columns.tr_mul(&moment);
            pi_rate += components;
            angular_impulse = body_from_global.tr_mul(&(self.axis_columns * components));
            power += force.dot(&velocity);
            if let Some(manifold) = &self.manifold {
                manifold.add_from_shapes(&e.force_in_shapes, &mut e.force);
            }
        }
        self.project_forces(speed, e);
        e.momentum.iter_mut().zip(&e.drive_stress).for_each(|(rate, k_q)| *rate += driven_acceleration * k_q);
        let force_rate = match self.translation {
            Translation::Free => force,
            Translation::Along(direction) => along(&first_attitude.tr_mul(&direction), &force),
            Translation::None | Translation::Driven(_) => Vector3::zeros(),
        };
        if self.drive.is_some() {
            let force_body = first_attitude * force;
            self.drive_effort(simd, driven_acceleration, &force_body, pi_rate[0], e);
            power += e.drive_effort * speed;
            pi_rate = Vector3::zeros();
        }
        set(&mut e.slow, part::THETA, &theta_rate);
        set(&mut e.slow, part::POSITION, &velocity);
        set(&mut e.slow, part::MOMENTUM, &force_rate);
        set(&mut e.slow, part::PI, &pi_rate);
        e.slow[part::WORK] = power;
        e.slow[part::DISSIPATION] = dissipation;
        set(&mut e.slow, part::ANGULAR_IMPULSE, &angular_impulse);
        set(&mut e.slow, part::IMPULSE, &force_rate);
        Ok(())
    }

    /// Adds the linear part of the modes to an evaluation: q' += p, p' −= Λq + Dp.
    pub(crate) fn add_linear(&self, e: &mut Evaluation) {
        for k in 0..e.q.len() {
            e.displacement[k] += e.p[k];
            e.momentum[k] += self.linear_rate(k, e.q[k], e.p[k]);
        }
    }

    /// −Λq − Dp
    pub(crate) fn linear_rate(&self, k: usize, q: f64, p: f64) -> f64 {
        let omega = self.circular_frequencies[k];
        -(omega * omega * q + self.damping[k] * p)
    }
}
