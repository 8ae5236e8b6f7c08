//! The rates of a state.

mod acceleration;
mod deformation;
pub(super) mod evaluation;
mod inertia_forces;
mod velocities;

use nalgebra::{Matrix3, Vector3};
use pulp::{Arch, Simd, WithSimd};
use rigid_kin::{f_inverse, transformation_matrix};

use crate::conservative::body::{ConservativeBody, Translation, along};
use crate::conservative::rates::evaluation::Evaluation;
use crate::conservative::state::{Slow, get, part, set};
use crate::error::RateError;
use crate::load::{Applied, Coordinates, Kinematics};
use crate::matrix::lists::dot;
use crate::state::State;

/// The rates of a state, in the widest vectors that the processor has.
struct Rates<'a> {
    body: &'a ConservativeBody,
    times: [f64; 2],
    first_attitude: &'a Matrix3<f64>,
    e: &'a mut Evaluation,
}

impl WithSimd for Rates<'_> {
    type Output = Result<(), RateError>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self { body, times, first_attitude, e } = self;
        body.find_rates(simd, times, first_attitude, e)
    }
}

impl ConservativeBody {
    /// All rates, without the linear part of the modes, at the place of `e` and the time and branch time `times`; the
    /// attitude at the start of the step has this transformation matrix.
    pub(crate) fn evaluate(
        &self,
        times: [f64; 2],
        first_attitude: &Matrix3<f64>,
        e: &mut Evaluation,
    ) -> Result<(), RateError> {
        Arch::new().dispatch(Rates { body: self, times, first_attitude, e })
    }

    /// The same at a state.
    pub(crate) fn evaluate_at(&self, state: &State, branch_time: f64, e: &mut Evaluation) -> Result<(), RateError> {
        e.at.values.copy_from_slice(&state.values);
        self.evaluate([state.time, branch_time], &self.list(state).attitude().global_to_body(), e)
    }

    #[inline(always)]
    fn find_rates<S: Simd>(
        &self,
        simd: S,
        [t, branch_time]: [f64; 2],
        first_attitude: &Matrix3<f64>,
        e: &mut Evaluation,
    ) -> Result<(), RateError> {
        let slow = &{ *e.at.slow() };
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
                let [_, p] = e.at.groups();
                right -= self.s_products(simd, &e.products, p);
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
            let Evaluation { at, rates, modal_velocity, in_shapes: [xi, nu, _], force_in_shapes, .. } = &mut *e;
            let (q, [_, momentum]) = (at.q(), rates.modes_mut());
            let (coordinates, mut applied);
            let (first, on_manifold) = (6, Some([q, &**modal_velocity]));
            if self.manifold.is_some() {
                force_in_shapes.fill(0.0);
                coordinates = Coordinates { first, displacement: xi, velocity: nu, on_manifold };
                applied = Applied::new(coordinates, Vector3::zeros(), force_in_shapes).on_manifold(momentum);
            } else {
                coordinates = Coordinates { first, displacement: q, velocity: modal_velocity, on_manifold: None };
                applied = Applied::new(coordinates, Vector3::zeros(), momentum);
            }
            let origin_global = self.frame.global_place(&get(slow, part::POSITION), t);
            let motion = Kinematics {
                time: t,
                branch_time,
                body_from_global: &body_from_global,
                origin_global,
                frame_origin_global: origin_global,
                origin_velocity_global: velocity + self.frame.velocity(),
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
        if let Some(reference) = &self.reference {
            let Evaluation { at, rates, .. } = &mut *e;
            let [_, momentum] = rates.modes_mut();
            reference.subtract_force(at.q(), momentum);
        }
        let [_, momentum] = e.rates.modes_mut();
        momentum.iter_mut().zip(&e.drive_stress).for_each(|(rate, k_q)| *rate += driven_acceleration * k_q);
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
        let mut rates: Slow = [0.0; 20];
        set(&mut rates, part::THETA, &theta_rate);
        set(&mut rates, part::POSITION, &velocity);
        set(&mut rates, part::MOMENTUM, &force_rate);
        set(&mut rates, part::PI, &pi_rate);
        rates[part::WORK] = power;
        rates[part::DISSIPATION] = dissipation;
        set(&mut rates, part::ANGULAR_IMPULSE, &angular_impulse);
        set(&mut rates, part::IMPULSE, &force_rate);
        e.rates.set_slow(&rates);
        Ok(())
    }

    /// Adds the linear part of the modes to an evaluation: q' += p, p' −= Λq + Dp.
    pub(super) fn add_oscillators(&self, e: &mut Evaluation) {
        let Evaluation { at, rates, .. } = e;
        let ([q_rate, p_rate], q, p) = (rates.modes_mut(), at.q(), at.p());
        for k in 0..q.len() {
            q_rate[k] += p[k];
            p_rate[k] += self.linear_rate(k, q[k], p[k]);
        }
    }

    /// −Λq − Dp
    pub(crate) fn linear_rate(&self, k: usize, q: f64, p: f64) -> f64 {
        let omega = self.circular_frequencies[k];
        -(omega * omega * q + self.damping[k] * p)
    }
}
