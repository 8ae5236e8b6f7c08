//! The linear modal model, Eqs. (32) to (35).

use dynamics::nalgebra::{Matrix3, Vector3};
use dynamics::reduced_body::ReducedBody;
use dynamics::{InertialMotion, SetupError, SharedLoad, Work, check_model};

use crate::body_motion::BodyMotion;

/// A state or a stage, as the linear modal model sees it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LinearMotion<'a> {
    /// Displacements of all modes (6+nf).
    pub displacement: &'a [f64],
    /// Velocities of all modes (6+nf).
    pub velocity: &'a [f64],
    /// The time at which branches of piecewise laws are chosen.
    pub branch_time: f64,
    /// Transformation matrix of the frame.
    pub body_from_global: &'a Matrix3<f64>,
    /// Where the frame's origin is, global components.
    pub origin_global: Vector3<f64>,
    /// Angular velocity, body components.
    pub omega_body: Vector3<f64>,
    /// Constants of the body that find the motion of its origin in the frame.
    pub motion: &'a BodyMotion,
}

/// Modal stiffness, damping and loads of mass-normalised modes: `q̈ = f_q − Λ q − D q̇`.
///
/// The first six coordinates are the rigid modes: no stiffness, and never damped.
#[derive(Debug, Clone)]
pub struct ModalModel {
    /// λ_k = ω_k² (6+nf).
    stiffness: Vec<f64>,
    /// 2 ζ_k ω_k (6+nf).
    damping: Vec<f64>,
    loads: Vec<SharedLoad>,
}

impl ModalModel {
    /// The model of a body with one damping ratio for each flexible mode.
    ///
    /// # Errors
    /// [`SetupError`] for a list of the wrong length, numbers that are negative or not finite, and rigid motions of a kind
    /// that has no equations here.
    pub fn new(body: &ReducedBody, damping_ratios: &[f64], loads: Vec<SharedLoad>) -> Result<Self, SetupError> {
        check_model(body, damping_ratios, &loads)?;
        let rigid = || std::iter::repeat_n(0.0, 6);
        let omega = &body.circular_frequencies;
        Ok(Self {
            stiffness: rigid().chain(omega.iter().map(|w| w * w)).collect(),
            damping: rigid().chain(omega.iter().zip(damping_ratios).map(|(w, zeta)| 2.0 * zeta * w)).collect(),
            loads,
        })
    }

    /// The loads.
    pub fn loads(&self) -> &[SharedLoad] {
        &self.loads
    }

    /// q̈ of (35) into `acceleration`, and the rates of the loads' work, of the dissipation and of the impulses. The loads
    /// are the mean of those at the given `times`.
    pub(crate) fn rates(&self, frame: &LinearMotion, times: &[f64], acceleration: &mut [f64]) -> Work {
        let LinearMotion { displacement, velocity, branch_time, body_from_global, omega_body, motion, .. } = *frame;
        // The centre of mass, which is the body's origin, and the point that moments are about.
        let center_body = motion.of_origin(displacement);
        let origin_global = frame.origin_global + body_from_global.tr_mul(&center_body);
        let origin_velocity_global = body_from_global.tr_mul(&motion.of_origin(velocity));
        let mut dissipation = 0.0;
        let modes = displacement.iter().zip(velocity).zip(self.stiffness.iter().zip(&self.damping));
        for (a, ((q, v), (lambda, d))) in acceleration.iter_mut().zip(modes) {
            *a = -lambda * q - d * v;
            dissipation += d * v * v;
        }
        let at = |time: f64| InertialMotion {
            time,
            branch_time,
            body_from_global,
            frame_origin_global: frame.origin_global,
            origin_global,
            origin_velocity_global,
            omega_body,
            modal_displacement: displacement,
            modal_velocity: velocity,
        };
        let mut applied = at(times[0]).applied(center_body, 1.0 / times.len() as f64, acceleration);
        for time in times {
            let kinematics = at(*time).kinematics();
            self.loads.iter().for_each(|load| load.apply(&kinematics, &mut applied));
        }
        Work {
            work: applied.modal_power,
            dissipation,
            impulse_global: body_from_global.tr_mul(&applied.force_body),
            angular_impulse_global: body_from_global.tr_mul(&applied.moment_body),
        }
    }

    /// Refuses a body with another number of modes.
    pub(crate) fn check_body(&self, body: &ReducedBody) -> Result<(), SetupError> {
        let (expected, found) = (body.flexible(), self.stiffness.len() - 6);
        if found == expected {
            return Ok(());
        }
        Err(SetupError::Length { what: "the modal model", expected, found })
    }

    /// Largest of ω_k and 2 ζ_k ω_k.
    pub(crate) fn fastest_rate(&self) -> f64 {
        let omega = self.stiffness.iter().map(|lambda| lambda.sqrt());
        omega.chain(self.damping.iter().copied()).fold(0.0, f64::max)
    }
}
