//! Motion of a rigid body without moments, in closed form.
//!
//! The angular velocity circles the principal axis of the largest or the smallest moment; call
//! it c, the other extreme one a, the middle one b, in a right-handed order. With σ = sign(I_c −
//! I_a) and s_a, s_c the signs of ω_a, ω_c at the start,
//!
//! ```text
//! ω_a = s_a A cn τ,    ω_b = σ s_a s_c B sn τ,    ω_c = s_c C dn τ,    τ = τ0 + λt
//! A² = ω_a0² + I_b(I_c−I_b)/(I_a(I_c−I_a)) ω_b0²       B² = A² I_a(I_c−I_a)/(I_b(I_c−I_b))
//! C² = ω_c0² + I_b(I_b−I_a)/(I_c(I_c−I_a)) ω_b0²       λ² = (I_c−I_b)(I_c−I_a)/(I_a I_b) C²
//! 1 − m = (ω_c0² − (I_b−I_a) I_a/((I_c−I_b) I_c) ω_a0²)/C²
//! ```
//!
//! with Jacobi's functions of parameter m (Landau & Lifshitz, Mechanics, §37, freed of the order
//! of the axes). The plane of c and the angular momentum L turns about L by ψ,
//!
//! ```text
//! ψ = (L/I_c) (t + (I_c−I_a)/(I_a λ) (Π(n; τ) − Π(n; τ0))),    Π(n; τ) = ∫₀^τ dw/(1 − n sn² w)
//! n = −I_c(I_b−I_a)/(I_a(I_c−I_b)) ≤ 0
//! ```
//!
//! which, with the direction of L in the body known from ω, gives the attitude. Π is Carlson's
//! R_F and R_J; at m = 1, the separatrix, everything is elementary.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use crate::attitude::Attitude;
use crate::elliptic::jacobi;
use crate::inertia::Inertia;

/// Errors of a free motion, or of its state at a time.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TorqueFreeError {
    /// The initial angular velocity is not finite, or its square leaves the range of f64.
    #[error(
        "the initial angular velocity {omega_body:?} is out of range; give finite components, \
         and a magnitude of zero or between 1e-140 and 1e140 rad/s"
    )]
    SpinOutOfRange {
        /// The angular velocity given (rad/s, body components).
        omega_body: [f64; 3],
    },
    /// The time is not finite.
    #[error("the state is asked for at the time {time}; give a finite time")]
    NotATime {
        /// The time given.
        time: f64,
    },
    /// An elliptic integral has no value.
    #[error(
        "an elliptic integral of the torque-free motion failed ({reason}); check that the inertia and the angular \
         velocity are of sensible size"
    )]
    EllipticIntegral {
        /// Message of the library of elliptic integrals.
        reason: &'static str,
    },
}

/// Kind of a free motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Regime {
    /// Constant angular velocity: about a principal axis, or no spin.
    Steady,
    /// ω circles the principal axis of the smallest moment.
    AboutSmallest,
    /// ω circles the principal axis of the largest moment.
    AboutLargest,
    /// Between the two: ω turns over once and tends to the middle axis.
    Separatrix,
}

/// Attitude and angular velocity at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueFreeState {
    /// Attitude of the body axes.
    pub attitude: Attitude,
    /// Angular velocity (rad/s), body components.
    pub omega_body: Vector3<f64>,
}

/// The motion of a rigid body about its centre of mass without moments, for any inertia and
/// start, in closed form.
///
/// Accurate to rounding, which grows in proportion to the angle turned, and near the separatrix
/// with the sensitivity of the motion itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueFreeMotion {
    start: TorqueFreeState,
    turning: Option<Turning>,
}

/// Constants of a motion whose angular velocity is not constant; axes in the order a, b, c.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Turning {
    regime: Regime,
    moments: Vector3<f64>,
    axes: Matrix3<f64>,
    /// Signed amplitudes of ω on cn, sn, dn.
    amplitudes: Vector3<f64>,
    rate: f64,
    phase: f64,
    complement: f64,
    characteristic: f64,
    /// K, half the half-period of τ; infinite on the separatrix.
    quarter_period: f64,
    /// Π over a quarter period; not used on the separatrix.
    third_kind_quarter: f64,
    /// Π(n; τ0).
    third_kind_phase: f64,
    angular_momentum: f64,
    /// From the frame of L and the node line at the start to the global frame.
    momentum_to_global: UnitQuaternion<f64>,
}

impl TorqueFreeMotion {
    /// The motion from `attitude` and `omega_body` (rad/s, body components) at time zero.
    ///
    /// # Errors
    /// [`TorqueFreeError::SpinOutOfRange`] if the angular velocity is not finite, or so small or
    /// large that its square is not a number.
    pub fn new(inertia: &Inertia, attitude: Attitude, omega_body: Vector3<f64>) -> Result<Self, TorqueFreeError> {
        let spin = omega_body.norm();
        if spin != 0.0 && !(1e-140..=1e140).contains(&spin) {
            return Err(TorqueFreeError::SpinOutOfRange { omega_body: omega_body.into() });
        }
        let start = TorqueFreeState { attitude, omega_body };
        Ok(Self { start, turning: Turning::new(inertia, &start)? })
    }

    /// Kind of motion.
    pub fn regime(&self) -> Regime {
        self.turning.map_or(Regime::Steady, |turning| turning.regime)
    }

    /// Parameter m of the elliptic functions, in [0, 1]: 0 for a symmetric body, 1 on the
    /// separatrix. `None` if the angular velocity is constant.
    pub fn parameter(&self) -> Option<f64> {
        self.turning.map(|turning| 1.0 - turning.complement)
    }

    /// Period of the angular velocity in body components, 4K/λ (s). `None` if the angular
    /// velocity is constant, or never returns (separatrix).
    pub fn period(&self) -> Option<f64> {
        self.turning
            .filter(|turning| turning.regime != Regime::Separatrix)
            .map(|turning| 4.0 * turning.quarter_period / turning.rate)
    }

    /// The state at `time` (s), which may be negative.
    ///
    /// # Errors
    /// [`TorqueFreeError::NotATime`] if the time is not finite.
    pub fn at(&self, time: f64) -> Result<TorqueFreeState, TorqueFreeError> {
        if !time.is_finite() {
            return Err(TorqueFreeError::NotATime { time });
        }
        match &self.turning {
            None => {
                let TorqueFreeState { attitude, omega_body } = self.start;
                Ok(TorqueFreeState { attitude: attitude.advanced_by(&(time * omega_body)), omega_body })
            }
            Some(turning) => turning.at(time),
        }
    }
}

impl Turning {
    fn new(inertia: &Inertia, start: &TorqueFreeState) -> Result<Option<Self>, TorqueFreeError> {
        let [smallest, middle, largest] = inertia.principal_moments();
        let principal_axes = inertia.principal_axes();
        let omega = principal_axes.transpose() * start.omega_body;
        if [(middle - smallest, 0, 1), (largest - middle, 1, 2), (largest - smallest, 2, 0)]
            .iter()
            .all(|&(difference, i, j)| difference * omega[i] * omega[j] == 0.0)
        {
            return Ok(None);
        }
        // The sign of L² − 2 T I_middle.
        let about_largest =
            (largest - middle) * (largest / smallest) * omega[2].powi(2) >= (middle - smallest) * omega[0].powi(2);
        let axis = |i: usize| Vector3::from(principal_axes.column(i));
        let (moments, axes) = if about_largest {
            (Vector3::new(smallest, middle, largest), *principal_axes)
        } else {
            (Vector3::new(largest, middle, smallest), Matrix3::from_columns(&[axis(2), -axis(1), axis(0)]))
        };
        let omega = axes.transpose() * start.omega_body;
        let ([i_a, i_b, i_c], [w_a, w_b, w_c]) = (<[f64; 3]>::from(moments), <[f64; 3]>::from(omega));

        let amplitude_a = w_a.hypot((i_b / i_a * ((i_c - i_b) / (i_c - i_a))).sqrt() * w_b);
        let amplitude_b = amplitude_a * (i_a / i_b * ((i_c - i_a) / (i_c - i_b))).sqrt();
        let amplitude_c = w_c.hypot((i_b / i_c * ((i_b - i_a) / (i_c - i_a))).sqrt() * w_b);
        let rate = ((i_c - i_b) / i_a * ((i_c - i_a) / i_b)).sqrt() * amplitude_c;
        let excess = w_c * w_c - (i_b - i_a) / (i_c - i_b) * (i_a / i_c) * w_a * w_a;
        let complement = (excess / amplitude_c.powi(2)).clamp(0.0, 1.0);
        let sign_b = (i_c - i_a).signum() * 1.0_f64.copysign(w_a) * 1.0_f64.copysign(w_c);
        let amplitudes = Vector3::new(amplitude_a.copysign(w_a), sign_b * amplitude_b, amplitude_c.copysign(w_c));

        let characteristic = -i_c / i_a * ((i_b - i_a) / (i_c - i_b));
        let [cn, sn, dn] = <[f64; 3]>::from(omega.component_div(&amplitudes));
        let phase = sn * first_kind(cn, dn)?;
        let separatrix = complement == 0.0;
        let mut turning = Self {
            regime: match (separatrix, about_largest) {
                (true, _) => Regime::Separatrix,
                (false, true) => Regime::AboutLargest,
                (false, false) => Regime::AboutSmallest,
            },
            moments,
            axes,
            amplitudes,
            rate,
            phase,
            complement,
            characteristic,
            quarter_period: if separatrix { f64::INFINITY } else { first_kind(0.0, complement.sqrt())? },
            third_kind_quarter: 0.0,
            third_kind_phase: 0.0,
            angular_momentum: moments.component_mul(&omega).norm(),
            momentum_to_global: UnitQuaternion::identity(),
        };
        if !separatrix {
            turning.third_kind_quarter = turning.third_kind(turning.quarter_period, 1.0, 0.0, complement.sqrt())?;
        }
        turning.third_kind_phase = turning.third_kind(phase, sn, cn, dn)?;
        turning.momentum_to_global = start.attitude.body_to_global() * turning.body_to_momentum(&omega).inverse();
        Ok(Some(turning))
    }

    fn at(&self, time: f64) -> Result<TorqueFreeState, TorqueFreeError> {
        let argument = self.phase + self.rate * time;
        // On the separatrix K is infinite and there is nothing to take off.
        let half_periods = (argument / (2.0 * self.quarter_period)).round();
        let rest = if half_periods == 0.0 { argument } else { argument - half_periods * 2.0 * self.quarter_period };
        let (sn, cn, dn) = jacobi(rest, self.complement);
        let sign = if half_periods.rem_euclid(2.0) == 0.0 { 1.0 } else { -1.0 };
        let omega = self.amplitudes.component_mul(&Vector3::new(sign * cn, sign * sn, dn));

        let third_kind = 2.0 * half_periods * self.third_kind_quarter + self.third_kind(rest, sn, cn, dn)?;
        let [i_a, _, i_c] = <[f64; 3]>::from(self.moments);
        let precession =
            self.angular_momentum / i_c * (time + (i_c - i_a) / i_a * (third_kind - self.third_kind_phase) / self.rate);
        let about_momentum = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), precession);
        let body_to_global = self.momentum_to_global * about_momentum * self.body_to_momentum(&omega);
        Ok(TorqueFreeState {
            attitude: Attitude::from_body_to_global(UnitQuaternion::new_normalize(body_to_global.into_inner())),
            omega_body: self.axes * omega,
        })
    }

    /// Π(n; τ) for τ in [−K, K], with sn, cn, dn of τ.
    fn third_kind(&self, argument: f64, sn: f64, cn: f64, dn: f64) -> Result<f64, TorqueFreeError> {
        let n = self.characteristic;
        if self.complement == 0.0 {
            let root = (-n).sqrt();
            return Ok((argument + root * (root * sn).atan()) / (1.0 - n));
        }
        // 1 − n sn² without cancellation.
        let p = cn * cn + (1.0 - n) * sn * sn;
        let r_j = ellip::elliprj(cn * cn, dn * dn, 1.0, p).map_err(elliptic_integral)?;
        Ok(argument + n / 3.0 * sn.powi(3) * r_j)
    }

    /// From body axes to the frame with z along the angular momentum L and x along c×L.
    fn body_to_momentum(&self, omega: &Vector3<f64>) -> UnitQuaternion<f64> {
        let along = self.moments.component_mul(omega).normalize();
        let node = Vector3::new(-along.y, along.x, 0.0).normalize();
        let rows = [node.transpose(), along.cross(&node).transpose(), along.transpose()];
        let matrix = Matrix3::from_rows(&rows) * self.axes.transpose();
        UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(matrix))
    }
}

/// R_F(cn², dn², 1): the argument τ over sn τ.
fn first_kind(cn: f64, dn: f64) -> Result<f64, TorqueFreeError> {
    ellip::elliprf(cn * cn, dn * dn, 1.0).map_err(elliptic_integral)
}

fn elliptic_integral(reason: &'static str) -> TorqueFreeError {
    TorqueFreeError::EllipticIntegral { reason }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::reference_points::euler_angular_acceleration;
    use crate::rigid_body::{RigidBody, RigidState, Wrench};
    use crate::samples::Samples;

    fn diagonal(a: f64, b: f64, c: f64) -> Inertia {
        Inertia::new(Matrix3::from_diagonal(&Vector3::new(a, b, c))).unwrap()
    }

    fn motion(inertia: &Inertia, omega: Vector3<f64>) -> TorqueFreeMotion {
        let attitude = Attitude::identity().advanced_by(&Vector3::new(0.4, -1.1, 0.8));
        TorqueFreeMotion::new(inertia, attitude, omega).unwrap()
    }

    /// Largest errors of attitude (rad) and angular velocity (relative) against the fourth-order
    /// integrator at `steps` steps up to `end`.
    fn against_integrator(inertia: &Inertia, omega: Vector3<f64>, end: f64, steps: u32) -> (f64, f64) {
        let motion = motion(inertia, omega);
        let body = RigidBody::new(1.0, *inertia.matrix()).unwrap();
        let step = end / f64::from(steps);
        let mut state = RigidState {
            attitude: motion.start.attitude,
            omega_body: omega,
            position_global: Vector3::zeros(),
            velocity_global: Vector3::zeros(),
        };
        let (mut attitude_error, mut omega_error) = (0.0_f64, 0.0_f64);
        for n in 1..=steps {
            state = body.step(&state, 0.0, step, |_, _| Wrench::zero()).unwrap();
            let exact = motion.at(f64::from(n) * step).unwrap();
            attitude_error = attitude_error.max(state.attitude.angle_to(&exact.attitude));
            omega_error = omega_error.max((state.omega_body - exact.omega_body).norm() / omega.norm());
        }
        (attitude_error, omega_error)
    }

    /// Constants of any free motion: angular momentum in the global frame, and energy.
    fn departure(inertia: &Inertia, motion: &TorqueFreeMotion, time: f64) -> f64 {
        let momentum = |s: &TorqueFreeState| s.attitude.to_global(&(inertia.matrix() * s.omega_body));
        let energy = |s: &TorqueFreeState| s.omega_body.dot(&(inertia.matrix() * s.omega_body));
        let (start, now) = (motion.at(0.0).unwrap(), motion.at(time).unwrap());
        let momentum_error = (momentum(&now) - momentum(&start)).norm() / momentum(&start).norm();
        momentum_error.max((energy(&now) / energy(&start) - 1.0).abs())
    }

    /// Independent reference: mpmath at 50 digits.
    #[test]
    fn benchmark_numbers() {
        let inertia = diagonal(1.0, 2.0, 3.0);
        let about_largest = motion(&inertia, Vector3::new(1.0, 2.0, 3.0));
        assert_eq!(about_largest.regime(), Regime::AboutLargest);
        assert!((about_largest.parameter().unwrap() - 5.0 / 31.0).abs() < 1e-15);
        assert!((about_largest.period().unwrap() - 2.041_488_040_54).abs() < 5e-12);

        let near_separatrix = motion(&inertia, Vector3::new(1e-4, 1.0, 1e-4));
        // mpmath at 50 digits. With 1 − m taken from m in f64, only nine of these digits are right.
        assert!((near_separatrix.parameter().unwrap() - 0.999_999_980_000_000_6).abs() < 2e-16);
        assert!((near_separatrix.period().unwrap() - 71.014_506_079_317).abs() < 1e-12);
    }

    /// Conserved: the state at time zero.
    #[test]
    fn starts_where_it_is_told() {
        let mut samples = Samples::new(12);
        for _ in 0..500 {
            let inertia = Inertia::new(samples.inertia_matrix()).unwrap();
            let omega = 3.0 * samples.vector();
            let motion = motion(&inertia, omega);
            let start = motion.at(0.0).unwrap();
            assert!((start.omega_body - omega).norm() < 1e-13, "{:e}", (start.omega_body - omega).norm());
            assert!(start.attitude.angle_to(&motion.start.attitude) < 1e-13);
        }
    }

    /// Conserved: angular momentum and energy.
    #[test]
    fn momentum_and_energy_are_constant_and_the_period_returns() {
        let mut samples = Samples::new(13);
        let (mut worst, mut about_largest) = (0.0_f64, 0);
        for _ in 0..500 {
            let inertia = Inertia::new(samples.inertia_matrix()).unwrap();
            let motion = motion(&inertia, 3.0 * samples.vector());
            for time in [0.1, 1.0, -7.0, 1000.0] {
                worst = worst.max(departure(&inertia, &motion, time));
            }
            let period = motion.period().unwrap();
            let change = motion.at(1.7 + period).unwrap().omega_body - motion.at(1.7).unwrap().omega_body;
            assert!(change.norm() < 1e-12, "{:e}", change.norm());
            about_largest += usize::from(motion.regime() == Regime::AboutLargest);
        }
        println!("worst departure {worst:e}, about the largest axis {about_largest} of 500");
        assert!(worst < 5e-15, "{worst:e}");
        assert!((100..400).contains(&about_largest));
    }

    /// |dA/dt + [ω×]A| and |dω/dt + J⁻¹(ω×Jω)| at s = 0, by sixth-order differences.
    fn residuals(inertia: &Inertia, state: impl Fn(f64) -> TorqueFreeState) -> (f64, f64) {
        let h = 1e-3;
        let a = |s: f64| state(s * h).attitude.global_to_body();
        let w = |s: f64| state(s * h).omega_body;
        let a_rate = (45.0 * (a(1.0) - a(-1.0)) - 9.0 * (a(2.0) - a(-2.0)) + a(3.0) - a(-3.0)) / (60.0 * h);
        let w_rate = (45.0 * (w(1.0) - w(-1.0)) - 9.0 * (w(2.0) - w(-2.0)) + w(3.0) - w(-3.0)) / (60.0 * h);
        let euler = euler_angular_acceleration(&Vector3::zeros(), inertia, &w(0.0));
        ((a_rate + w(0.0).cross_matrix() * a(0.0)).norm(), (w_rate - euler).norm())
    }

    /// Conserved: dA/dt = −[ω×]A and Euler's equation, at scattered times, so that the precession angle is right, not
    /// the direction of the angular momentum alone.
    #[test]
    fn kinematics_and_eulers_equation_hold() {
        let mut samples = Samples::new(14);
        let mut worst = [0.0_f64; 2];
        for _ in 0..300 {
            let inertia = Inertia::new(samples.inertia_matrix()).unwrap();
            let motion = motion(&inertia, samples.vector());
            let time = 20.0 * samples.number();
            let (attitude_residual, omega_residual) = residuals(&inertia, |s| motion.at(time + s).unwrap());
            worst = [worst[0].max(attitude_residual), worst[1].max(omega_residual)];
        }
        println!("worst residuals of attitude and omega {worst:?}");
        assert!(worst[0] < 3e-11 && worst[1] < 3e-11, "{worst:?}");
    }

    /// Independent reference: the fourth-order integrator.
    #[test]
    fn every_regime_agrees_with_the_integrator() {
        let inertia = diagonal(1.0, 2.0, 3.0);
        let symmetric = diagonal(2.0, 2.0, 1.3);
        let cases = [
            (inertia, Vector3::new(1.0, 2.0, 3.0), Regime::AboutLargest, 6.0),
            (inertia, Vector3::new(-3.0, 1.0, -0.5), Regime::AboutSmallest, 6.0),
            (inertia, Vector3::new(2.0, -1.0, 1.0), Regime::AboutSmallest, 6.0),
            (inertia, Vector3::new(-1.0, 1.0, -1.0), Regime::AboutLargest, 12.0),
            (inertia, Vector3::new(0.0, 1.0, 1.0), Regime::AboutLargest, 12.0),
            (inertia, Vector3::new(1.0, -1.0, 0.0), Regime::AboutSmallest, 12.0),
            (symmetric, Vector3::new(1.0, 2.0, 3.0), Regime::AboutSmallest, 6.0),
            (diagonal(1.0, 3.0, 3.0 * (1.0 - 1e-15)), Vector3::new(1.0, 1.0, 0.1), Regime::AboutSmallest, 6.0),
            (diagonal(1.0, 1.0, 1.9), Vector3::new(1.0, -2.0, -1.0), Regime::AboutLargest, 6.0),
            (diagonal(1.0, 1.0, 1.0), Vector3::new(1.0, -2.0, -1.0), Regime::Steady, 6.0),
            (inertia, Vector3::new(0.0, 0.0, -2.0), Regime::Steady, 6.0),
            (inertia, Vector3::new(0.0, 0.0, 0.0), Regime::Steady, 6.0),
            (inertia, Vector3::new(1e-9, 1e-9, 3.0), Regime::AboutLargest, 6.0),
            (diagonal(5.4925, 2112.71125, 2117.78125), Vector3::new(3.0, 8.0, 5.0), Regime::AboutLargest, 6.0),
        ];
        for (inertia, omega, regime, end) in cases {
            assert_eq!(motion(&inertia, omega).regime(), regime, "{omega}");
            if omega.norm() > 0.0 {
                let (attitude_error, omega_error) = against_integrator(&inertia, omega, end, 40_000);
                println!("{omega:?} {regime:?}: attitude {attitude_error:e}, omega {omega_error:e}");
                assert!(attitude_error < 1e-11, "{omega}: {attitude_error:e}");
                assert!(omega_error < 1e-11, "{omega}: {omega_error:e}");
            }
        }
    }

    /// Independent reference: the fourth-order integrator. The first 40 s hold the passage from the middle axis to
    /// its opposite and half the way back. Every later pass multiplies the rounding of the integrator by 1/m₁ = 5e7
    /// or so: after the whole period of 71 s the two differ by 1e-8 to 1e-6, whatever the step.
    #[test]
    fn near_the_separatrix_agrees_with_the_integrator() {
        let inertia = diagonal(1.0, 2.0, 3.0);
        let omega = Vector3::new(1e-4, 1.0, 1e-4);
        // Measured: 7e-12, and 1e-13 up to 20 s.
        let (attitude_error, omega_error) = against_integrator(&inertia, omega, 40.0, 40_000);
        assert!(attitude_error < 1e-10, "{attitude_error:e}");
        assert!(omega_error < 1e-10, "{omega_error:e}");
    }

    /// Conserved: the same over two periods by what holds at each instant: dA/dt = −[ω×]A, Euler's equation and the
    /// constants, also across the joints of the half-periods.
    #[test]
    fn near_the_separatrix_the_equations_hold_at_every_instant() {
        let inertia = diagonal(1.0, 2.0, 3.0);
        let motion = motion(&inertia, Vector3::new(1e-4, 1.0, 1e-4));
        let turning = motion.turning.unwrap();
        let joint = |n: i32| (f64::from(2 * n + 1) * turning.quarter_period - turning.phase) / turning.rate;
        let mut worst = [0.0_f64; 3];
        for time in (0..560).map(|n| 0.25 * f64::from(n)).chain((-3..4).map(joint)) {
            let state = |s: f64| motion.at(time + s).unwrap();
            let (attitude_residual, omega_residual) = residuals(&inertia, state);
            let now = [attitude_residual, omega_residual, departure(&inertia, &motion, time)];
            worst = [0, 1, 2].map(|i| worst[i].max(now[i]));
        }
        println!("worst residuals of attitude and omega, and departure: {worst:?}");
        assert!(worst[0] < 2e-10 && worst[1] < 5e-11 && worst[2] < 3e-15, "{worst:?}");
    }

    /// Independent reference: the fourth-order integrator. (I3−I2) I3 ω3² = (I2−I1) I1 ω1² holds exactly for these
    /// numbers.
    #[test]
    fn on_the_separatrix_the_motion_is_hyperbolic() {
        let inertia = diagonal(1.5, 3.0, 4.0);
        for (start, flip) in [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0)] {
            let omega = Vector3::new(4.0 * start, 0.3 * flip, 3.0);
            let motion = motion(&inertia, omega);
            assert_eq!(motion.regime(), Regime::Separatrix);
            assert_eq!((motion.period(), motion.parameter()), (None, Some(1.0)));
            let (attitude_error, omega_error) = against_integrator(&inertia, omega, 4.0, 40_000);
            println!("attitude {attitude_error:e}, omega {omega_error:e}");
            assert!(attitude_error < 1e-10, "{attitude_error:e}");
            assert!(omega_error < 1e-10, "{omega_error:e}");
            let end = motion.at(1e4).unwrap();
            assert!(end.omega_body.xz().norm() < 1e-300);
            assert!(departure(&inertia, &motion, 1e4) < 1e-14);
        }
    }

    /// Closed form: the spin turns at (I3 − I1)/I1 ω3, the axis at L/I1.
    #[test]
    fn a_symmetric_body_precesses_steadily() {
        // I1 = I2 = 2, I3 = 3.2: the spin turns about the axis of symmetry at
        // (I3−I1)/I1 ω3, and the axis about the angular momentum at L/I1.
        let inertia = diagonal(2.0, 2.0, 3.2);
        let omega = Vector3::new(0.6, -0.8, 1.5);
        let motion = motion(&inertia, omega);
        let body_rate = (3.2 - 2.0) / 2.0 * 1.5;
        assert!((motion.period().unwrap() / (TAU / body_rate) - 1.0).abs() < 1e-15);
        let momentum_body = inertia.matrix() * omega;
        let precession_rate = momentum_body.norm() / 2.0;
        let momentum_global = motion.start.attitude.to_global(&momentum_body).normalize();
        for time in [0.5, 3.0, 100.0, -20.0] {
            let state = motion.at(time).unwrap();
            let spin = Rotation3::new(Vector3::z() * body_rate * time) * omega;
            assert!((state.omega_body - spin).norm() < 3e-15 * (1.0 + time.abs()));
            let axis = state.attitude.to_global(&Vector3::z());
            let start_axis = motion.start.attitude.to_global(&Vector3::z());
            let expected = Rotation3::new(momentum_global * precession_rate * time) * start_axis;
            assert!((axis - expected).norm() < 3e-15 * (1.0 + time.abs()), "{time}");
        }
    }

    /// Conserved: near the middle axis, near steady spin and for nearly equal moments the constants still hold, and
    /// the attitude is smooth.
    #[test]
    fn extreme_cases_keep_the_constants() {
        let mut worst = 0.0_f64;
        for inertia in [diagonal(1.0, 2.0, 3.0), diagonal(1.0, 1.0 + 1e-12, 1.5), diagonal(1e-6, 1.0, 1.0 + 1e-9)] {
            for small in [1e-3, 1e-9, 1e-20, 1e-100] {
                for omega in [
                    Vector3::new(small, 1.0, 0.0),
                    Vector3::new(0.0, 1.0, small),
                    Vector3::new(-small, 1.0, small),
                    Vector3::new(1.0, small, small),
                    Vector3::new(small, small, -1.0),
                ] {
                    let motion = motion(&inertia, omega);
                    for time in [0.0, 0.3, 40.0] {
                        worst = worst.max(departure(&inertia, &motion, time));
                    }
                }
            }
        }
        println!("worst departure {worst:e}");
        assert!(worst < 3e-15, "{worst:e}");
    }

    #[test]
    fn what_is_no_motion_is_refused() {
        let inertia = diagonal(1.0, 2.0, 3.0);
        for omega in [Vector3::repeat(f64::NAN), Vector3::new(f64::INFINITY, 0.0, 0.0), Vector3::repeat(1e-150)] {
            let refused = TorqueFreeMotion::new(&inertia, Attitude::identity(), omega);
            assert!(matches!(refused, Err(TorqueFreeError::SpinOutOfRange { .. })));
        }
        let motion = motion(&inertia, Vector3::x());
        assert!(matches!(motion.at(f64::NAN), Err(TorqueFreeError::NotATime { .. })));
    }
}
