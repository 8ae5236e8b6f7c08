//! Attitude as a unit quaternion, advanced by the rotation vector of each step.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

use crate::rotation::{NotARotation, SMALL, quaternion_body_to_global, sinc, small_cos, small_sinc};

/// Four numbers that are not a rotation.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "{wxyz:?} is not a rotation; give a quaternion [w, x, y, z] of finite numbers, not all zero \
     ([1, 0, 0, 0] leaves the body unturned)"
)]
pub struct NotAQuaternion {
    /// The numbers given, in the order w, x, y, z.
    pub wxyz: [f64; 4],
}

/// The attitude of a body: the rotation between its body axes and the global axes. Serde has it as [w, x, y, z], bit for
/// bit.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(into = "[f64; 4]", try_from = "[f64; 4]")]
pub struct Attitude {
    body_to_global: UnitQuaternion<f64>,
}

impl From<Attitude> for [f64; 4] {
    fn from(attitude: Attitude) -> Self {
        attitude.wxyz()
    }
}

impl TryFrom<[f64; 4]> for Attitude {
    type Error = NotAQuaternion;

    fn try_from(wxyz: [f64; 4]) -> Result<Self, NotAQuaternion> {
        Self::from_unit_wxyz(wxyz)
    }
}

impl Attitude {
    /// Body axes along the global axes.
    pub fn identity() -> Self {
        Self { body_to_global: UnitQuaternion::identity() }
    }

    /// From a quaternion [w, x, y, z] that takes body to global components; it is scaled to
    /// length one.
    ///
    /// # Errors
    /// [`NotAQuaternion`] if it is zero or not finite.
    pub fn from_wxyz(wxyz: [f64; 4]) -> Result<Self, NotAQuaternion> {
        let [w, x, y, z] = wxyz;
        let norm = Quaternion::new(w, x, y, z).norm();
        if norm.is_normal() {
            Ok(Self { body_to_global: UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z)) })
        } else {
            Err(NotAQuaternion { wxyz })
        }
    }

    /// From what [`Self::wxyz`] gave, bit for bit.
    ///
    /// # Errors
    /// [`NotAQuaternion`] if its length is not one to 1e-9.
    pub fn from_unit_wxyz(wxyz: [f64; 4]) -> Result<Self, NotAQuaternion> {
        let [w, x, y, z] = wxyz;
        let quaternion = Quaternion::new(w, x, y, z);
        if (quaternion.norm() - 1.0).abs() < 1e-9 {
            Ok(Self { body_to_global: UnitQuaternion::new_unchecked(quaternion) })
        } else {
            Err(NotAQuaternion { wxyz })
        }
    }

    /// From what [`Self::wxyz`] gave, bit for bit and unchecked: numbers of another kind stay wrong.
    pub fn from_wxyz_unchecked([w, x, y, z]: [f64; 4]) -> Self {
        Self { body_to_global: UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z)) }
    }

    /// From the matrix A of (18), which takes global to body components.
    ///
    /// # Errors
    /// [`NotARotation`] if the matrix is not a rotation to 1e-6.
    pub fn from_global_to_body(a: &Matrix3<f64>) -> Result<Self, NotARotation> {
        Ok(Self { body_to_global: quaternion_body_to_global(a)? })
    }

    pub(crate) fn from_body_to_global(body_to_global: UnitQuaternion<f64>) -> Self {
        Self { body_to_global }
    }

    pub(crate) fn body_to_global(&self) -> UnitQuaternion<f64> {
        self.body_to_global
    }

    /// The unit quaternion [w, x, y, z] that takes body to global components. Its sign is that
    /// of a continuous motion: it does not jump when the angle passes π.
    pub fn wxyz(&self) -> [f64; 4] {
        let q = self.body_to_global.quaternion();
        [q.w, q.i, q.j, q.k]
    }

    /// The matrix A of (18): `v_body = A v_global`. Its rows are the body axes in global
    /// components.
    pub fn global_to_body(&self) -> Matrix3<f64> {
        self.body_to_global.to_rotation_matrix().into_inner().transpose()
    }

    /// Global components of a vector given in body components.
    pub fn to_global(&self, v_body: &Vector3<f64>) -> Vector3<f64> {
        self.body_to_global * v_body
    }

    /// Body components of a vector given in global components.
    pub fn to_body(&self, v_global: &Vector3<f64>) -> Vector3<f64> {
        self.body_to_global.inverse_transform_vector(v_global)
    }

    /// The attitude after a further turn by `rotation_vector_body` (rad, components in the body
    /// axes before or after the turn, which agree): A becomes exp(−[θ×]) A.
    ///
    /// This is the re-anchoring of the rotation vector: each step's vector starts at zero, so
    /// the singularity of (22) at 2π is never met. The quaternion is scaled back to length one,
    /// so rounding does not accumulate in its length.
    pub fn advanced_by(&self, rotation_vector_body: &Vector3<f64>) -> Self {
        let half = 0.5 * rotation_vector_body;
        let square = half.norm_squared();
        let turn = if square < SMALL {
            Quaternion::from_parts(small_cos(square), small_sinc(square) * half)
        } else {
            let half_angle = square.sqrt();
            Quaternion::from_parts(half_angle.cos(), sinc(half_angle) * half)
        };
        Self { body_to_global: UnitQuaternion::new_normalize(self.body_to_global.quaternion() * turn) }
    }

    /// Angle (rad, in [0, π]) of the turn from this attitude to the other; accurate to rounding
    /// for tiny angles also.
    pub fn angle_to(&self, other: &Self) -> f64 {
        let turn = self.body_to_global.quaternion().conjugate() * other.body_to_global.quaternion();
        2.0 * turn.vector().norm().atan2(turn.w.abs())
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI, TAU};

    use super::*;
    use crate::rotation::transformation_matrix;
    use crate::samples::Samples;

    /// Independent reference: products of the transformation matrices.
    #[test]
    fn advancing_multiplies_the_transformation_matrices() {
        let mut samples = Samples::new(5);
        for _ in 0..1000 {
            let (first, second) = (3.0 * samples.vector(), 3.0 * samples.vector());
            let attitude = Attitude::identity().advanced_by(&first).advanced_by(&second);
            let expected = transformation_matrix(&second) * transformation_matrix(&first);
            assert!((attitude.global_to_body() - expected).amax() < 2e-15);
            let v = samples.vector();
            assert!((attitude.to_body(&v) - expected * v).norm() < 3e-15);
            assert!((attitude.to_global(&attitude.to_body(&v)) - v).norm() < 2e-15);
            let again = Attitude::from_global_to_body(&expected).unwrap();
            assert!(again.angle_to(&attitude) < 3e-15);
        }
    }

    /// Closed form: a quarter turn about z.
    #[test]
    fn quaternions_are_body_to_global_with_w_first() {
        let half = FRAC_PI_2 / 2.0;
        let attitude = Attitude::from_wxyz([2.0 * half.cos(), 0.0, 0.0, 2.0 * half.sin()]).unwrap();
        assert!((attitude.to_global(&Vector3::x()) - Vector3::y()).norm() < 1e-15);
        let expected = Attitude::identity().advanced_by(&Vector3::new(0.0, 0.0, FRAC_PI_2));
        assert!(attitude.angle_to(&expected) < 1e-15);
        assert!((attitude.wxyz()[0] - half.cos()).abs() < 1e-15);
        for wxyz in [[0.0; 4], [f64::NAN, 0.0, 0.0, 1.0], [f64::INFINITY, 0.0, 0.0, 0.0]] {
            assert!(Attitude::from_wxyz(wxyz).is_err());
        }
    }

    /// Closed form: the angle of the turn.
    #[test]
    fn tiny_and_large_angles_are_measured_to_rounding() {
        let start = Attitude::identity();
        for angle in [1e-150, 1e-20, 1e-12, 1e-6, 1.0, 3.0, PI] {
            let found = start.angle_to(&start.advanced_by(&Vector3::new(0.0, angle, 0.0)));
            assert!((found / angle - 1.0).abs() < 1e-15, "{angle}: {found}");
        }
        let turned = start.advanced_by(&Vector3::new(1.0, -2.0, 0.5));
        let further = turned.advanced_by(&Vector3::new(0.0, 0.0, 1e-9));
        assert!((turned.angle_to(&further) - 1e-9).abs() < 3e-16);
        assert!(start.angle_to(&start.advanced_by(&Vector3::new(TAU, 0.0, 0.0))) < 1e-15);
    }

    /// Closed form: one turn by the sum of the steps: 100 rad/s about an oblique axis, 7/1024 rad a step, 10⁷ steps:
    /// 10 879 turns.
    #[test]
    fn ten_thousand_turns_lose_nothing_but_rounding() {
        let step = Vector3::new(2.0, 3.0, 6.0) / 1024.0;
        let steps = 10_000_000_u32;
        let start = Attitude::from_wxyz([0.5, -0.1, 0.7, 0.3]).unwrap();
        let end = (0..steps).fold(start, |attitude, _| attitude.advanced_by(&step));
        // Every component times 10⁷ is exact in binary, so the closed form is exact too.
        let error = end.angle_to(&start.advanced_by(&(f64::from(steps) * step)));
        let norm_error = (end.wxyz().iter().map(|c| c * c).sum::<f64>() - 1.0).abs();
        let a = end.global_to_body();
        let departure = (a * a.transpose() - Matrix3::identity()).amax();
        println!("attitude {error:e} rad, norm {norm_error:e}, orthonormality {departure:e}");
        // Measured: 1.5e-11 rad of 68 359 turned, which is two roundings of the angle itself.
        assert!(error < 3e-11, "{error:e}");
        assert!(norm_error < 5e-16, "{norm_error:e}");
        assert!(departure < 1e-15, "{departure:e}");
    }
}
