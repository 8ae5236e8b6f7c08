//! The linear modal model, Eqs. (32) to (35).

use modal::ReducedBody;
use nalgebra::{Matrix3, Vector3};

use crate::error::SetupError;
use crate::load::{Applied, Coordinates, Kinematics, SharedLoad};
use crate::motion::BodyMotion;
use crate::work::Work;

/// A motion in an inertial frame, as the linear modal model sees it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LinearMotion<'a> {
    /// Of all modes (6+nf).
    pub coordinates: Coordinates<'a>,
    /// The time at which branches of piecewise laws are chosen.
    pub branch_time: f64,
    /// Transformation matrix of the frame.
    pub body_from_global: &'a Matrix3<f64>,
    /// Where the frame's origin is, global components.
    pub origin_global: Vector3<f64>,
    /// Angular velocity, body components.
    pub omega_body: Vector3<f64>,
    /// What finds the motion of the centre of mass in the frame.
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
        check_motion(body)?;
        check_damping(damping_ratios, body.flexible())?;
        loads.iter().try_for_each(|load| load.check(body.flexible()))?;
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
        let LinearMotion {
            coordinates,
            branch_time,
            body_from_global,
            origin_global: frame_origin_global,
            omega_body,
            motion,
        } = *frame;
        let Coordinates { displacement, velocity, .. } = coordinates;
        // The centre of mass, which is the body's origin, and the point that moments are about.
        let center_body = motion.of_origin(displacement);
        let origin_global = frame_origin_global + body_from_global.tr_mul(&center_body);
        let origin_velocity_global = body_from_global.tr_mul(&motion.of_origin(velocity));
        let mut dissipation = 0.0;
        let modes = displacement.iter().zip(velocity).zip(self.stiffness.iter().zip(&self.damping));
        for (a, ((q, v), (lambda, d))) in acceleration.iter_mut().zip(modes) {
            *a = -lambda * q - d * v;
            dissipation += d * v * v;
        }
        let mut applied = Applied::new(coordinates, center_body, acceleration);
        applied.weight = 1.0 / times.len() as f64;
        for time in times {
            let (time, unit) = (*time, false);
            let motion = Kinematics {
                time,
                branch_time,
                body_from_global,
                origin_global,
                origin_velocity_global,
                omega_body,
                frame_origin_global,
                coordinates,
                unit,
            };
            self.loads.iter().for_each(|load| load.apply(&motion, &mut applied));
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

    /// Largest stable step of RK4, and the flexible mode (from 0) that sets it.
    pub(crate) fn stable_step(&self) -> (usize, f64) {
        let limits = self.stiffness.iter().zip(&self.damping).skip(6).map(|(lambda, d)| stable_step(*lambda, *d));
        limits.enumerate().fold((0, f64::INFINITY), |best, next| if next.1 < best.1 { next } else { best })
    }

    /// Refuses a step at which classical RK4 amplifies a mode: |R(z)| > 1 for an eigenvalue z/step of H.
    pub(crate) fn check_step(&self, step: f64) -> Result<(), SetupError> {
        if !(step > 0.0 && step.is_finite()) {
            return Err(SetupError::Value { what: "the step", found: step, expected: "a positive number" });
        }
        let (mode, limit) = self.stable_step();
        if step <= limit {
            return Ok(());
        }
        let frequency = self.stiffness[6 + mode].sqrt() / std::f64::consts::TAU;
        Err(SetupError::StepBeyondLimit { step, limit, mode: mode + 1, frequency })
    }
}

/// Refuses a body whose rigid motions are of a kind that has no equations here.
pub(crate) fn check_motion(body: &ReducedBody) -> Result<(), SetupError> {
    if body.motion.others().is_empty() { Ok(()) } else { Err(SetupError::MotionLeft { motion: Box::new(body.motion) }) }
}

/// Refuses damping ratios that are not one number of zero or more for each mode.
pub(crate) fn check_damping(damping_ratios: &[f64], flexible: usize) -> Result<(), SetupError> {
    if damping_ratios.len() != flexible {
        let found = damping_ratios.len();
        return Err(SetupError::Length { what: "the list of damping ratios", expected: flexible, found });
    }
    match damping_ratios.iter().copied().find(|zeta| !(*zeta >= 0.0 && zeta.is_finite())) {
        Some(found) => Err(SetupError::Value { what: "a damping ratio", found, expected: "zero or more" }),
        None => Ok(()),
    }
}

/// Largest step for which RK4 does not amplify `q̈ + d q̇ + λ q = 0`; 2.83/ω without damping.
fn stable_step(lambda: f64, damping: f64) -> f64 {
    let omega = lambda.sqrt();
    let stable = |step: f64| amplification(lambda * step * step, damping * step) <= 1.0 + 1e-12;
    // The stability region meets each ray once: bisect between a step well inside and one well outside.
    let (mut inside, mut outside) = (0.0, 4.0 / (omega + damping).max(f64::MIN_POSITIVE) * 2.0);
    for _ in 0..60 {
        let middle = 0.5 * (inside + outside);
        if stable(middle) { inside = middle } else { outside = middle }
    }
    inside
}

/// max |R(z)|, R(z) = 1 + z + z²/2 + z³/6 + z⁴/24, over the roots of z² + d z + λ = 0.
fn amplification(lambda: f64, damping: f64) -> f64 {
    let discriminant = 0.25 * damping * damping - lambda;
    let r = |re: f64, im: f64| {
        let (mut sum, mut term) = ((1.0, 0.0), (1.0, 0.0));
        for k in 1..=4 {
            let k = f64::from(k);
            term = ((term.0 * re - term.1 * im) / k, (term.0 * im + term.1 * re) / k);
            sum = (sum.0 + term.0, sum.1 + term.1);
        }
        f64::hypot(sum.0, sum.1)
    };
    if discriminant < 0.0 {
        r(-0.5 * damping, (-discriminant).sqrt())
    } else {
        let root = discriminant.sqrt();
        r(-0.5 * damping - root, 0.0).max(r(-0.5 * damping + root, 0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rk4_is_stable_to_two_root_two_over_omega_and_to_2_785_on_the_negative_axis() {
        for omega in [1e-3, 1.0, 3659.0] {
            assert!((stable_step(omega * omega, 0.0) * omega - 8.0_f64.sqrt()).abs() < 1e-6);
        }
        // Strong damping: the fast root is near -d, and the real stability interval of RK4 ends at -2.7853.
        let damping = 1e4;
        assert!((stable_step(1.0, damping) * damping - 2.7853).abs() < 1e-3);
    }
}
