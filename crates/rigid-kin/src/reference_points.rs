//! Angular velocity and acceleration from the linear motion of three points: Eqs. (4)–(16).

use nalgebra::{Matrix3, Vector3};

use crate::inertia::Inertia;

/// Smallest sine of the angle at R that is accepted; (5)–(12) divide by it.
const SMALLEST_SINE: f64 = 1e-6;

/// Points whose distance is less than this share of their coordinates have lost their direction.
const SMALLEST_RELATIVE_DISTANCE: f64 = 1e-9;

/// Three reference points that do not span a plane.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "the reference points R {reference:?}, P {p:?}, Q {q:?} do not span a plane: the sine of the \
     angle at R between P and Q is {sine:.3e}, and (5)-(12) need 1e-6 at least; choose three \
     distinct, well-spread points that are not on one line"
)]
pub struct CollinearPoints {
    /// Sine of the angle at R; 0 if P or Q falls on R, NaN if a coordinate is not finite.
    pub sine: f64,
    /// R, body components.
    pub reference: [f64; 3],
    /// P, body components.
    pub p: [f64; 3],
    /// Q, body components.
    pub q: [f64; 3],
}

/// The paper's points R, P, Q on a body, with the oblique unit vectors of (4).
///
/// All vectors, in and out, have body components; relative means of P, or of Q, less that of R.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReferencePoints {
    e1: Vector3<f64>,
    e2: Vector3<f64>,
    e3: Vector3<f64>,
    p: f64,
    q: f64,
    sine: f64,
}

impl ReferencePoints {
    /// Takes the positions of R, P, Q (body components) and forms e1, e2, e3 of (4):
    /// e1 = p/|p|, e2 = q/|q|, e3 = e1×e2/|e1×e2| with p = P − R, q = Q − R.
    ///
    /// # Errors
    /// [`CollinearPoints`] if the sine |e1×e2| is below 1e-6, or two points fall together.
    pub fn new(reference: &Vector3<f64>, p: &Vector3<f64>, q: &Vector3<f64>) -> Result<Self, CollinearPoints> {
        let (to_p, to_q) = (p - reference, q - reference);
        let (length_p, length_q) = (to_p.norm(), to_q.norm());
        let extent = reference.amax().max(p.amax()).max(q.amax());
        let coincident = length_p.min(length_q) <= SMALLEST_RELATIVE_DISTANCE * extent;
        let (e1, e2) = (to_p / length_p, to_q / length_q);
        let normal = e1.cross(&e2);
        let sine = if coincident { 0.0 } else { normal.norm() };
        if sine.is_nan() || sine < SMALLEST_SINE {
            return Err(CollinearPoints { sine, reference: (*reference).into(), p: (*p).into(), q: (*q).into() });
        }
        Ok(Self { e1, e2, e3: normal / sine, p: length_p, q: length_q, sine })
    }

    /// The matrix B of (4), whose rows are e1, e2, e3 in body components. Its transpose takes
    /// oblique to body components, which is (8) and (13); it is orthogonal only if RP ⟂ RQ.
    pub fn oblique_from_body(&self) -> Matrix3<f64> {
        Matrix3::from_rows(&[self.e1.transpose(), self.e2.transpose(), self.e3.transpose()])
    }

    /// Angular velocity ω (rad/s), the function g of (9), by (5)–(8), from the velocities of P
    /// and Q relative to R.
    ///
    /// Exact if the velocities are those of a rigid motion.
    pub fn angular_velocity(&self, v_p: &Vector3<f64>, v_q: &Vector3<f64>) -> Vector3<f64> {
        let Self { e1, e2, e3, p, q, sine } = self;
        let omega_3 = v_p.dot(&(e2 - e1 * e1.dot(e2))) / (p * sine); // (5)
        let omega_2 = -v_p.dot(e3) / (p * sine); // (6)
        let omega_1 = v_q.dot(e3) / (q * sine); // (7)
        omega_1 * e1 + omega_2 * e2 + omega_3 * e3 // (8)
    }

    /// Angular acceleration α (rad/s²), the function h of (14), by (10)–(13), from the velocities
    /// and accelerations of P and Q relative to R and the angular velocity ω.
    ///
    /// Exact if the accelerations are those of a rigid motion, a = α×p + ω×(ω×p), centripetal
    /// part included.
    ///
    /// # Not Euler's equation
    /// A linear modal model gives a = α_modal×p, without the centripetal part. Then h returns
    /// `α_modal − (ω2ω3, −ω1ω3, ω1ω2)`, in the axes e1, e3×e1, e3 (x along RP, z normal to the
    /// plane of the points), whatever the body is. The two components in the plane are Euler's
    /// for every flat lamina in this plane; the normal one is Euler's for a lamina with its mass
    /// on the line RP alone, where `(I2−I1)/(I1+I2) = 1`. It depends on the direction of RP, and
    /// on Q not at all. So h is right in plane motion about e1, e3 or e3×e1, close for a long thin plate with RP along
    /// it, and wrong otherwise: a sphere that spins freely gets an angular acceleration.
    /// [`euler_angular_acceleration`] is right for any body.
    pub fn angular_acceleration(
        &self,
        v_p: &Vector3<f64>,
        v_q: &Vector3<f64>,
        a_p: &Vector3<f64>,
        a_q: &Vector3<f64>,
        omega: &Vector3<f64>,
    ) -> Vector3<f64> {
        let Self { e1, e2, e3, p, q, sine } = self;
        let alpha_3 = (e3.cross(&omega.cross(v_p)) - e3.cross(a_p)).dot(e1) / p; // (10)
        let alpha_2 = (omega.cross(v_p) - a_p).dot(e3) / (p * sine); // (11)
        let alpha_1 = (a_q - omega.cross(v_q)).dot(e3) / (q * sine); // (12)
        alpha_1 * e1 + alpha_2 * e2 + alpha_3 * e3 // (13)
    }
}

/// Rate of a relative velocity's body components, (15) for P and (16) for Q: `a − ω×v`.
pub fn relative_velocity_rate(
    acceleration: &Vector3<f64>,
    velocity: &Vector3<f64>,
    omega: &Vector3<f64>,
) -> Vector3<f64> {
    acceleration - omega.cross(velocity)
}

/// Angular acceleration by Euler's equation, `α_modal − J⁻¹(ω×Jω)` (rad/s², body components).
///
/// `alpha_modal` is the angular acceleration of the rigid modes of the linear model, J⁻¹ times
/// the moment about the centre of mass; `omega` is ω in body components.
pub fn euler_angular_acceleration(alpha_modal: &Vector3<f64>, inertia: &Inertia, omega: &Vector3<f64>) -> Vector3<f64> {
    alpha_modal - inertia.inverse() * omega.cross(&(inertia.matrix() * omega))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::attitude::Attitude;
    use crate::samples::Samples;
    use crate::torque_free::TorqueFreeMotion;

    struct Case {
        points: ReferencePoints,
        p: Vector3<f64>,
        q: Vector3<f64>,
        omega: Vector3<f64>,
        alpha: Vector3<f64>,
    }

    /// Oblique points with an angle at R of 0.3 rad or more from a line.
    fn cases() -> impl Iterator<Item = Case> {
        let mut samples = Samples::new(7);
        std::iter::from_fn(move || {
            let (reference, p, q) = (samples.vector(), samples.vector(), samples.vector());
            let (omega, alpha) = (samples.vector(), samples.vector());
            let points = ReferencePoints::new(&reference, &(reference + p), &(reference + q)).unwrap();
            Some(Case { points, p, q, omega, alpha })
        })
        .filter(|case| case.points.sine > 0.3 && case.points.p.min(case.points.q) > 0.3)
        .take(2000)
    }

    /// Closed form: the unit vectors along p, q and p×q.
    #[test]
    fn rows_of_b_are_the_oblique_unit_vectors() {
        for Case { points, p, q, .. } in cases() {
            let b = points.oblique_from_body();
            assert!((b.row(0).transpose() - p.normalize()).norm() < 5e-15);
            assert!((b.row(1).transpose() - q.normalize()).norm() < 5e-15);
            assert!((b.row(2).transpose() - p.cross(&q).normalize()).norm() < 2e-14);
            // det B is the triple product e1·(e2×e3) = |e1×e2|.
            assert!((b.determinant() - points.sine).abs() < 1e-15);
        }
    }

    /// Closed form: ω of a rigid motion.
    #[test]
    fn g_recovers_the_angular_velocity_of_a_rigid_motion() {
        for Case { points, p, q, omega, .. } in cases() {
            let found = points.angular_velocity(&omega.cross(&p), &omega.cross(&q));
            assert!((found - omega).norm() < 2e-14, "{:e}", (found - omega).norm());
        }
    }

    /// Closed form: α of a rigid motion.
    #[test]
    fn h_recovers_the_angular_acceleration_of_a_rigid_motion() {
        for Case { points, p, q, omega, alpha } in cases() {
            let v = |r: &Vector3<f64>| omega.cross(r);
            let a = |r: &Vector3<f64>| alpha.cross(r) + omega.cross(&v(r));
            let found = points.angular_acceleration(&v(&p), &v(&q), &a(&p), &a(&q), &omega);
            assert!((found - alpha).norm() < 3e-14, "{:e}", (found - alpha).norm());
        }
    }

    /// Closed form: Euler's equation of a lamina.
    #[test]
    fn h_takes_every_body_for_a_lamina_in_the_plane_of_the_points() {
        for Case { points, p, q, omega, alpha } in cases() {
            let found = points.angular_acceleration(
                &omega.cross(&p),
                &omega.cross(&q),
                &alpha.cross(&p),
                &alpha.cross(&q),
                &omega,
            );
            let plane = Matrix3::from_columns(&[points.e1, points.e3.cross(&points.e1), points.e3]);
            let w = plane.transpose() * omega;
            let expected = alpha - plane * Vector3::new(w.y * w.z, -w.x * w.z, w.x * w.y);
            assert!((found - expected).norm() < 3e-14, "{:e}", (found - expected).norm());

            let none = Vector3::zeros();
            let lamina = |a, b| Inertia::new(Matrix3::from_diagonal(&Vector3::new(a, b, a + b))).unwrap();
            let found = plane.transpose() * (found - alpha);
            // Measured: 5e-8, since 1e-9 beside 1 keeps seven digits.
            let line = euler_angular_acceleration(&none, &lamina(1e-9, 1.0), &w);
            assert!((found - line).norm() < 5e-7, "{:e}", (found - line).norm());
            let plate = euler_angular_acceleration(&none, &lamina(0.3, 1.0), &w);
            assert!((found - plate).xy().norm() < 3e-14, "{:e}", (found - plate).norm());
            assert!((found.z * 0.7 / 1.3 - plate.z).abs() < 3e-14);
        }
    }

    /// Closed form: α×p.
    #[test]
    fn relative_velocity_rate_is_the_time_derivative_of_body_components() {
        for Case { p, omega, alpha, .. } in cases().take(50) {
            // d/dt (ω×p) in body components, where p is constant, is α×p.
            let v = omega.cross(&p);
            let a = alpha.cross(&p) + omega.cross(&v);
            assert!((relative_velocity_rate(&a, &v, &omega) - alpha.cross(&p)).norm() < 1e-15);
        }
    }

    /// Second derivative by a fourth-order central difference.
    fn second_difference(h: f64, f: impl Fn(f64) -> Vector3<f64>) -> Vector3<f64> {
        (16.0 * (f(h) + f(-h)) - f(2.0 * h) - f(-2.0 * h) - 30.0 * f(0.0)) / (12.0 * h * h)
    }

    /// Closed form: a free sphere has no angular acceleration.
    #[test]
    fn a_free_sphere_keeps_its_spin_but_not_by_h_of_modal_accelerations() {
        let sphere = Inertia::new(0.4 * Matrix3::identity()).unwrap();
        let omega = Vector3::new(1.0, 2.0, 3.0);
        let points = ReferencePoints::new(&Vector3::zeros(), &Vector3::x(), &Vector3::y()).unwrap();
        let motion = TorqueFreeMotion::new(&sphere, Attitude::identity(), omega).unwrap();
        let (v_p, v_q) = (omega.cross(&Vector3::x()), omega.cross(&Vector3::y()));

        let global = |point: &Vector3<f64>, t: f64| motion.at(t).unwrap().attitude.to_global(point);
        let a_p = second_difference(2e-3, |t| global(&Vector3::x(), t));
        let a_q = second_difference(2e-3, |t| global(&Vector3::y(), t));
        let from_true_motion = points.angular_acceleration(&v_p, &v_q, &a_p, &a_q, &omega);
        assert!(from_true_motion.norm() < 3e-9, "{:e}", from_true_motion.norm());

        let none = Vector3::zeros();
        let from_modes = points.angular_acceleration(&v_p, &v_q, &none, &none, &omega);
        assert!((from_modes - Vector3::new(-6.0, 3.0, -2.0)).norm() < 1e-14);
        assert_eq!(euler_angular_acceleration(&none, &sphere, &omega), none);
    }

    /// Independent reference: differences in time of the torque-free motion.
    #[test]
    fn euler_is_the_time_derivative_of_the_angular_velocity() {
        let mut samples = Samples::new(8);
        for _ in 0..50 {
            let inertia = Inertia::new(samples.inertia_matrix()).unwrap();
            let omega = samples.vector();
            let motion = TorqueFreeMotion::new(&inertia, Attitude::identity(), omega).unwrap();
            let h = 2e-3;
            let w = |t: f64| motion.at(t).unwrap().omega_body;
            let slope = (8.0 * (w(h) - w(-h)) - w(2.0 * h) + w(-2.0 * h)) / (12.0 * h);
            let euler = euler_angular_acceleration(&Vector3::zeros(), &inertia, &omega);
            assert!((slope - euler).norm() < 1e-10, "{:e}", (slope - euler).norm());
        }
    }

    #[test]
    fn points_on_a_line_are_refused_with_the_sine() {
        let at = |x: f64, y: f64| Vector3::new(x, y, 0.0);
        let error = ReferencePoints::new(&at(0.0, 0.0), &at(1.0, 0.0), &at(-2.0, 1e-7)).unwrap_err();
        assert!((error.sine - 5e-8).abs() < 1e-20);
        assert!(error.to_string().contains("5"));
        assert!(ReferencePoints::new(&at(0.0, 0.0), &at(1.0, 0.0), &at(1.0, 1.1e-6)).is_ok());

        let coincident = ReferencePoints::new(&at(1.0, 2.0), &at(1.0, 2.0), &at(3.0, 0.0));
        assert_eq!(coincident.unwrap_err().sine, 0.0);
        // 1e-13 apart at coordinates of 1000 is rounding, not a direction.
        let coincident = ReferencePoints::new(&at(1000.0, 0.0), &at(1000.0, 1e-13), &at(0.0, 0.0));
        assert_eq!(coincident.unwrap_err().sine, 0.0);
        let on_each_other = ReferencePoints::new(&at(0.0, 0.0), &at(1.0, 1.0), &at(1.0, 1.0));
        assert_eq!(on_each_other.unwrap_err().sine, 0.0);
        assert!(ReferencePoints::new(&at(f64::NAN, 0.0), &at(1.0, 0.0), &at(0.0, 1.0)).is_err());
    }
}
