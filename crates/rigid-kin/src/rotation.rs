//! A = exp(−[θ×]), its inverse, and the rate of the rotation vector: Eqs. (17)–(22).

use std::f64::consts::TAU;

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

/// A rotation vector of a full turn or more, where (22) is singular.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "the rotation vector has an angle of {angle} rad; its rate (22) exists below a full turn \
     (2π) only: start the rotation vector from zero at every step, and take a step shorter than \
     a turn"
)]
pub struct BeyondFullTurn {
    /// Angle found (rad); NaN if the rotation vector was not finite.
    pub angle: f64,
}

/// A matrix that is not a rotation.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "the matrix is not a rotation: |A Aᵀ − I| is {departure:e} and det A is {determinant}; give \
     three orthogonal rows of length one that form a right-handed frame"
)]
pub struct NotARotation {
    /// Frobenius norm of A Aᵀ − I.
    pub departure: f64,
    /// det A; −1 for a reflection.
    pub determinant: f64,
}

/// [v×], the 3×3 matrix with `cross_matrix(v) * u = v × u`.
///
/// The paper's M̂ (17) and Ω (21) are `−cross_matrix(λ)` and `−cross_matrix(ω)`.
pub fn cross_matrix(v: &Vector3<f64>) -> Matrix3<f64> {
    v.cross_matrix()
}

/// A = exp(θM̂) = exp(−[θ×]) of (18) and (19): from global to body components.
///
/// `rotation_vector` is axis times angle (rad) of the turn that carries the global axes onto the
/// body axes; any angle is allowed. The form `I − (sin θ/θ)[θ×] + ½(sin(θ/2)/(θ/2))²[θ×]²` has no
/// cancellation, so it holds full relative accuracy down to θ = 0. Both factors are summed as series where few terms do.
pub fn transformation_matrix(rotation_vector: &Vector3<f64>) -> Matrix3<f64> {
    let square = rotation_vector.norm_squared();
    let (sine, cosine) = if square < SMALL {
        (
            small_sinc(square),
            0.5 - square * (1.0 / 24.0) * (1.0 - square * (1.0 / 30.0) * (1.0 - square * (1.0 / 56.0))),
        )
    } else {
        let angle = square.sqrt();
        (sinc(angle), 0.5 * sinc(0.5 * angle).powi(2))
    };
    let (linear, quadratic) = (rotation_vector * sine, rotation_vector * cosine);
    let [x, y, z] = (*rotation_vector).into();
    let [xx, yy, zz] = [quadratic.x * x, quadratic.y * y, quadratic.z * z];
    let [xy, xz, yz] = [quadratic.x * y, quadratic.x * z, quadratic.y * z];
    Matrix3::new(
        1.0 - (yy + zz),
        xy + linear.z,
        xz - linear.y,
        xy - linear.z,
        1.0 - (xx + zz),
        yz + linear.x,
        xz + linear.y,
        yz - linear.x,
        1.0 - (xx + yy),
    )
}

/// The rotation vector θ, with angle in [0, π], of A = exp(−[θ×]); inverse of
/// [`transformation_matrix`].
///
/// At an angle of π the vector and its negative are the same rotation; one of them is returned.
///
/// # Errors
/// [`NotARotation`] if `a` is not a rotation to 1e-6.
pub fn rotation_vector(a: &Matrix3<f64>) -> Result<Vector3<f64>, NotARotation> {
    Ok(quaternion_body_to_global(a)?.scaled_axis())
}

/// The unit quaternion that takes body to global components, of the matrix that takes global to
/// body components.
pub(crate) fn quaternion_body_to_global(global_to_body: &Matrix3<f64>) -> Result<UnitQuaternion<f64>, NotARotation> {
    let departure = (global_to_body * global_to_body.transpose() - Matrix3::identity()).norm();
    let determinant = global_to_body.determinant();
    if departure < 1e-6 && determinant > 0.0 {
        let body_to_global = Rotation3::from_matrix_unchecked(global_to_body.transpose());
        let quaternion = UnitQuaternion::from_rotation_matrix(&body_to_global);
        Ok(UnitQuaternion::new_normalize(quaternion.into_inner()))
    } else {
        Err(NotARotation { departure, determinant })
    }
}

/// Rate of the rotation vector, f⁻¹ of (20)–(22) in vector form (rad/s):
///
/// ```text
/// θ' = ω + ½ θ×ω + (1 − (θ/2) cot(θ/2))/θ² · θ×(θ×ω)
/// ```
///
/// `rotation_vector` is θ (rad), `omega_body` the angular velocity in body components (rad/s).
/// The last factor goes to 1/12 at θ = 0 and is summed as a series for θ < 1.
///
/// # The paper's signs
/// The paper defines ad_M̂ = −\[M̂, •\] with the bracket \[M̂, N̂\] = N̂M̂ − M̂N̂. Both are the
/// reverse of custom, and together they are the ordinary commutator M̂N̂ − N̂M̂. Taken as printed,
/// (20)–(22) agree with dA/dt = ΩA for A = exp(θM̂) (checked by differences, and equal to the
/// vector form to rounding); either sign reversed alone gives a wrong rate.
///
/// # Errors
/// [`BeyondFullTurn`] from 2π on, where (22) is singular, and for vectors that are not finite.
pub fn f_inverse(rotation_vector: &Vector3<f64>, omega_body: &Vector3<f64>) -> Result<Vector3<f64>, BeyondFullTurn> {
    let square = rotation_vector.norm_squared();
    let factor = if square < SMALL {
        SERIES[..4].iter().rev().fold(0.0, |sum, term| sum * square + term)
    } else {
        let angle = rotation_vector.norm();
        if angle.is_nan() || angle >= TAU {
            return Err(BeyondFullTurn { angle });
        }
        half_cotangent_factor(angle)
    };
    let turn = rotation_vector.cross(omega_body);
    Ok(omega_body + 0.5 * turn + factor * rotation_vector.cross(&turn))
}

/// Square of an angle, rad², below which four terms of a series hold to rounding.
pub(crate) const SMALL: f64 = 1e-3;

/// sin x / x of a small x, by its square.
pub(crate) fn small_sinc(square: f64) -> f64 {
    1.0 - square * (1.0 / 6.0) * (1.0 - square * (1.0 / 20.0) * (1.0 - square * (1.0 / 42.0)))
}

/// cos x of a small x, by its square.
pub(crate) fn small_cos(square: f64) -> f64 {
    1.0 - square * 0.5 * (1.0 - square * (1.0 / 12.0) * (1.0 - square * (1.0 / 30.0)))
}

/// sin x / x.
pub(crate) fn sinc(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { x.sin() / x }
}

/// |B_2k|/(2k)! for k = 1 … 10, with the Bernoulli numbers B: coefficients of (1 − (θ/2) cot(θ/2))/θ². The next term is
/// below one rounding at θ = 1.
const SERIES: [f64; 10] = [
    1.0 / 12.0,
    1.0 / 720.0,
    1.0 / 30_240.0,
    1.0 / 1_209_600.0,
    1.0 / 47_900_160.0,
    691.0 / 1_307_674_368_000.0,
    1.0 / 74_724_249_600.0,
    3_617.0 / 10_670_622_842_880_000.0,
    43_867.0 / 5_109_094_217_170_944_000.0,
    174_611.0 / 802_857_662_698_291_200_000.0,
];

/// (1 − (θ/2) cot(θ/2))/θ² for 0 ≤ θ < 2π.
pub fn half_cotangent_factor(angle: f64) -> f64 {
    if angle < 1.0 {
        SERIES.iter().rev().fold(0.0, |sum, term| sum * angle * angle + term)
    } else {
        let half = 0.5 * angle;
        (1.0 - half / half.tan()) / (angle * angle)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::samples::Samples;

    /// exp(−[θ×]) by its defining series, summed from the smallest term.
    fn exponential_series(rotation_vector: &Vector3<f64>) -> Matrix3<f64> {
        let m = -cross_matrix(rotation_vector);
        let identity = Matrix3::identity();
        (1..=60).rev().fold(identity, |sum, k| identity + m * sum / f64::from(k))
    }

    fn angles() -> impl Iterator<Item = f64> {
        (0..=260).map(|k| 1e-12 * 10_f64.powf(f64::from(k) / 20.0)).filter(|&angle| angle < TAU)
    }

    /// Independent reference: the series of the exponential.
    #[test]
    fn transformation_matrix_is_the_exponential_at_every_angle() {
        let mut samples = Samples::new(1);
        for angle in angles() {
            let theta = angle * samples.unit_vector();
            let a = transformation_matrix(&theta);
            let series = exponential_series(&theta);
            // Measured: 7e-15 at the largest angle, where the series itself cancels.
            let tolerance = if angle < 1.0 { 5e-16 } else { 2e-14 };
            assert!((a - series).amax() < tolerance, "{angle}: {:e}", (a - series).amax());
            let sine_part = 0.5 * (a.transpose() - a);
            let error = (sine_part - sinc(angle) * cross_matrix(&theta)).amax();
            assert!(error < 1e-16 + 1e-15 * angle, "{angle}: {error:e}");
        }
    }

    /// Closed form: the first terms of sin θ/θ and (1 − cos θ)/θ².
    #[test]
    fn transformation_matrix_holds_relative_accuracy_for_tiny_angles() {
        let theta = Vector3::new(2.0, -3.0, 6.0);
        for scale in [1e-3, 1e-8, 1e-12, 1e-160, 1e-300] {
            let a = transformation_matrix(&(scale * theta));
            let angle: f64 = 7.0 * scale;
            // The first terms left out of sin θ/θ and (1 − cos θ)/θ² are below one rounding.
            let s = 1.0 - angle.powi(2) / 6.0 + angle.powi(4) / 120.0;
            let c = 0.5 - angle.powi(2) / 24.0 + angle.powi(4) / 720.0;
            let expected = s * scale * 6.0 + c * scale * scale * 2.0 * -3.0;
            let relative = (a[(0, 1)] - expected).abs() / expected.abs();
            assert!(relative < 5e-16, "{scale}: {relative:e}");
        }
        assert_eq!(transformation_matrix(&Vector3::zeros()), Matrix3::identity());
    }

    /// Closed form: a quarter turn about z.
    #[test]
    fn transformation_matrix_is_passive() {
        // A body turned by +90° about z has its x axis along global y.
        let a = transformation_matrix(&Vector3::new(0.0, 0.0, PI / 2.0));
        assert!((a * Vector3::y() - Vector3::x()).norm() < 1e-15);
    }

    /// Conserved: the rotation vector of its own matrix.
    #[test]
    fn rotation_vector_inverts_up_to_half_a_turn() {
        let mut samples = Samples::new(2);
        for angle in angles().filter(|&angle| angle < PI).chain([PI - 1e-3, PI - 1e-7]) {
            let theta = angle * samples.unit_vector();
            let found = rotation_vector(&transformation_matrix(&theta)).unwrap();
            assert!((found - theta).norm() < 2e-15 * angle.max(0.1), "{angle}");
            if angle < 1e-3 {
                assert!((found - theta).norm() < 1e-15 * angle, "{angle}");
            }
        }
        let half_turn = PI * samples.unit_vector();
        let found = rotation_vector(&transformation_matrix(&half_turn)).unwrap();
        let error = (found - half_turn).norm().min((found + half_turn).norm());
        assert!(error < 2e-15, "{error:e}");
        assert_eq!(rotation_vector(&Matrix3::identity()).unwrap(), Vector3::zeros());
    }

    #[test]
    fn what_is_no_rotation_is_refused() {
        for matrix in [-Matrix3::identity(), 2.0 * Matrix3::identity(), Matrix3::zeros(), Matrix3::repeat(f64::NAN)] {
            assert!(rotation_vector(&matrix).is_err());
        }
    }

    /// (1 − (θ/2)cot(θ/2))/θ² = 2 Σ ζ(2k) θ^(2k−2)/(2π)^(2k).
    fn zeta_series(angle: f64) -> f64 {
        let zeta = |s: i32| match s {
            2 => PI.powi(2) / 6.0,
            4 => PI.powi(4) / 90.0,
            6 => PI.powi(6) / 945.0,
            _ => (1..=400).rev().map(|n| f64::from(n).powi(-s)).sum(),
        };
        (1..=150).rev().map(|k| 2.0 * zeta(2 * k) * (angle / TAU).powi(2 * k - 2) / TAU.powi(2)).sum()
    }

    /// Independent reference: the series in ζ(2k).
    #[test]
    fn factor_of_the_double_cross_product_is_exact_and_has_no_jump() {
        for angle in angles().filter(|&angle| angle < 5.0).chain([0.0, 0.999_999, 1.000_001]) {
            let relative = half_cotangent_factor(angle) / zeta_series(angle) - 1.0;
            // The closed form subtracts 0.915 from 1 at θ = 1.
            let tolerance = if angle < 1.0 { 6e-16 } else { 2.5e-15 };
            assert!(relative.abs() < tolerance, "{angle}: {relative:e}");
        }
        let jump = half_cotangent_factor(1.0) - half_cotangent_factor(1.0_f64.next_down());
        assert!(jump.abs() < 2e-16, "{jump:e}");
        assert_eq!(half_cotangent_factor(0.0), 1.0 / 12.0);
    }

    /// (20)–(22) in matrices, with the sign of ad and the order in the bracket as arguments; the
    /// paper prints ad = −[M̂, •] and [M̂, N̂] = N̂M̂ − M̂N̂.
    fn f_inverse_matrix(theta: &Vector3<f64>, omega: &Vector3<f64>, ad_sign: f64, bracket_sign: f64) -> Matrix3<f64> {
        let angle = theta.norm();
        let m_hat = -cross_matrix(&(theta / angle));
        let capital_omega = -cross_matrix(omega);
        let bracket = |n: &Matrix3<f64>| bracket_sign * (n * m_hat - m_hat * n);
        let ad = |n: &Matrix3<f64>| ad_sign * bracket(n);
        let ad_omega = ad(&capital_omega);
        let half = 0.5 * angle;
        capital_omega - half * ad_omega - (half / half.tan() - 1.0) * ad(&ad_omega)
    }

    /// Independent reference: (20)–(22) in matrices.
    #[test]
    fn vector_form_is_the_papers_matrix_form() {
        let mut samples = Samples::new(3);
        for _ in 0..2000 {
            let theta = 6.2 * samples.number().abs().max(0.01) * samples.unit_vector();
            let omega = samples.vector();
            let paper = f_inverse_matrix(&theta, &omega, -1.0, 1.0);
            let ours = -cross_matrix(&f_inverse(&theta, &omega).unwrap());
            let scale = paper.amax().max(1.0);
            assert!((ours - paper).amax() < 4e-15 * scale, "{:e}", (ours - paper).amax());
        }
    }

    /// Independent reference: sixth-order differences of the exponential.
    #[test]
    fn signs_as_printed_are_those_of_the_exponential() {
        let mut samples = Samples::new(4);
        let h = 1e-3;
        for _ in 0..200 {
            let theta = 6.0 * samples.number().abs().max(0.05) * samples.unit_vector();
            let omega = samples.vector();
            // |dA/dt − ΩA| along the rate under test, by a sixth-order central difference.
            let residual = |rate: &Vector3<f64>| {
                let a = |s: f64| transformation_matrix(&(theta + s * h * rate));
                let slope = (45.0 * (a(1.0) - a(-1.0)) - 9.0 * (a(2.0) - a(-2.0)) + a(3.0) - a(-3.0)) / (60.0 * h);
                (slope + cross_matrix(&omega) * a(0.0)).norm()
            };
            let from_matrix = |m: &Matrix3<f64>| -Vector3::new(m[(2, 1)], m[(0, 2)], m[(1, 0)]);
            let right = residual(&f_inverse(&theta, &omega).unwrap());
            assert!(right < 1e-10, "{right:e}");
            let printed = residual(&from_matrix(&f_inverse_matrix(&theta, &omega, -1.0, 1.0)));
            assert!(printed < 1e-10, "{printed:e}");
            let reversed = residual(&from_matrix(&f_inverse_matrix(&theta, &omega, 1.0, 1.0)));
            let expected = theta.cross(&omega).norm();
            assert!(reversed > 0.01 * expected, "{reversed:e} {expected:e}");
        }
    }

    #[test]
    fn a_full_turn_is_refused() {
        let omega = Vector3::x();
        let error = f_inverse(&Vector3::new(0.0, TAU, 0.0), &omega).unwrap_err();
        assert_eq!(error.angle, TAU);
        assert!(f_inverse(&Vector3::new(0.0, TAU.next_down(), 0.0), &omega).is_ok());
        assert!(f_inverse(&Vector3::new(f64::NAN, 0.0, 0.0), &omega).is_err());
        assert!(f_inverse(&Vector3::new(f64::INFINITY, 0.0, 0.0), &omega).is_err());
    }
}
