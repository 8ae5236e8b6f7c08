//! The differential equation that the paper's scheme tends to as the step goes to zero, solved to fourth order.
//!
//! ```text
//! θ' = f⁻¹(θ) ω,   q' = y − G(ω) q less its rigid displacement,   y' = f_q(A) − Λ q − D y − G(ω) y
//! ```
//!
//! with all components co-rotating and `G(ω) = Ψᵀ M (I⊗[ω×]) Ψ`.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use rigid_kin::{Attitude, f_inverse};

use crate::common::Specimen;

pub struct LimitEquation<F> {
    rotation_basis: Matrix3<f64>,
    /// Ψᵀ M (I⊗[e_i×]) Ψ.
    cross: [DMatrix<f64>; 3],
    stiffness: DVector<f64>,
    damping: DVector<f64>,
    /// Ψᵀ F(t, global to body).
    force: F,
    pub attitude: Attitude,
    pub displacement: DVector<f64>,
    pub velocity: DVector<f64>,
}

impl<F: Fn(f64, &Matrix3<f64>) -> DVector<f64>> LimitEquation<F> {
    pub fn new(specimen: &Specimen, damping_ratio: f64, force: F, displacement: &[f64], velocity: &[f64]) -> Self {
        let body = &specimen.body;
        let size = 6 + body.flexible();
        let cross = [Vector3::<f64>::x(), Vector3::y(), Vector3::z()].map(|axis| {
            let matrix = axis.cross_matrix();
            let entry = |i: usize, j: usize, a: usize, b: usize| matrix[(a, b)] * body.rotation_products[a][b][(i, j)];
            DMatrix::from_fn(size, size, |i, j| (0..9).map(|ab| entry(i, j, ab / 3, ab % 3)).sum())
        });
        let omega = DVector::from_fn(size, |k, _| if k < 6 { 0.0 } else { body.circular_frequencies[k - 6] });
        Self {
            rotation_basis: body.rotation_basis,
            cross,
            stiffness: omega.map(|w| w * w),
            damping: omega.map(|w| 2.0 * damping_ratio * w),
            force,
            attitude: Attitude::identity(),
            displacement: DVector::from_column_slice(displacement),
            velocity: DVector::from_column_slice(velocity),
        }
    }

    /// One step of classical RK4 on (θ, q, y), θ from zero.
    pub fn step(&mut self, t: f64, h: f64) {
        let size = self.displacement.len();
        let rate = |t: f64, (theta, q, y): &(Vector3<f64>, DVector<f64>, DVector<f64>)| {
            let omega = self.rotation_basis * Vector3::new(y[3], y[4], y[5]);
            let g = &self.cross[0] * omega.x + &self.cross[1] * omega.y + &self.cross[2] * omega.z;
            let moving = DVector::from_fn(size, |k, _| if k < 6 { 0.0 } else { y[k] });
            let f = (self.force)(t, &self.attitude.advanced_by(theta).global_to_body());
            (
                f_inverse(theta, &omega).unwrap(),
                moving - &g * q,
                f - self.stiffness.component_mul(q) - self.damping.component_mul(y) - &g * y,
            )
        };
        let start = (Vector3::zeros(), self.displacement.clone(), self.velocity.clone());
        let ahead = |k: &(Vector3<f64>, DVector<f64>, DVector<f64>), h: f64| {
            (start.0 + h * k.0, &start.1 + h * &k.1, &start.2 + h * &k.2)
        };
        let k1 = rate(t, &start);
        let k2 = rate(t + 0.5 * h, &ahead(&k1, 0.5 * h));
        let k3 = rate(t + 0.5 * h, &ahead(&k2, 0.5 * h));
        let k4 = rate(t + h, &ahead(&k3, h));
        let theta = h / 6.0 * (k1.0 + 2.0 * k2.0 + 2.0 * k3.0 + k4.0);
        let displacement = start.1 + h / 6.0 * (k1.1 + 2.0 * k2.1 + 2.0 * k3.1 + k4.1);
        let velocity = start.2 + h / 6.0 * (k1.2 + 2.0 * k2.2 + 2.0 * k3.2 + k4.2);
        self.attitude = self.attitude.advanced_by(&theta);
        self.displacement = displacement;
        self.velocity = velocity;
    }
}
