//! The functions φ_k of exponential integrators, of a damped oscillator's matrix.
//!
//! ```text
//! φ_0(z) = eᶻ,   φ_{k+1}(z) = (φ_k(z) − 1/k!) / z,   φ_k(0) = 1/k!
//! ```
//!
//! For a 2×2 matrix A with eigenvalues z₁, z₂: `φ(A) = φ(z₁) I + φ[z₁, z₂] (A − z₁ I)`, with the divided difference
//! φ[z₁, z₂], which at critical damping becomes the derivative φ_k' = φ_k − k φ_{k+1}.

use nalgebra::{Complex, Matrix2};

/// φ_0 … φ_3 of a matrix.
pub(crate) type Phis = [Matrix2<f64>; 4];

/// φ_0 … φ_3 of `h·[[0, 1], [−ω², −2ζω]]`.
pub(crate) fn oscillator_phis(omega: f64, damping_ratio: f64, h: f64) -> Phis {
    let matrix = Matrix2::new(0.0, h, -h * omega * omega, -2.0 * h * damping_ratio * omega);
    let (mean, half_gap) = eigenvalues(omega, damping_ratio, h);
    let z2 = mean - half_gap;
    // z₁z₂ = (ωh)²: beyond critical damping the sum would cancel.
    let z1 = if half_gap.re > 0.0 { (omega * h).powi(2) / z2 } else { mean + half_gap };
    let (at_z1, at_z2) = (phis(z1), phis(z2));
    std::array::from_fn(|k| {
        let slope =
            if half_gap.norm() > 0.5 { (at_z1[k] - at_z2[k]) / (z1 - z2) } else { mean_derivative(k, mean, half_gap) };
        // Eigenvalues are real or a conjugate pair, so both coefficients are real.
        let constant = at_z1[k] - slope * z1;
        Matrix2::identity() * constant.re + matrix * slope.re
    })
}

/// Mean and half the difference of the eigenvalues of `h·[[0, 1], [−ω², −2ζω]]`.
fn eigenvalues(omega: f64, zeta: f64, h: f64) -> (Complex<f64>, Complex<f64>) {
    let mean = Complex::new(-zeta * omega * h, 0.0);
    let radicand = (zeta - 1.0) * (zeta + 1.0);
    let root = radicand.abs().sqrt() * omega * h;
    (mean, if radicand < 0.0 { Complex::new(0.0, root) } else { Complex::new(root, 0.0) })
}

/// φ_0 … φ_4 of a number.
fn phis(z: Complex<f64>) -> [Complex<f64>; 5] {
    let mut phi = [Complex::new(0.0, 0.0); 5];
    if z.norm() < 1.0 {
        // φ_4 by its series, the others downwards: φ_k = 1/k! + z φ_{k+1}, without cancellation.
        let mut term = Complex::new(1.0 / 24.0, 0.0);
        for n in 5..26 {
            phi[4] += term;
            term *= z / f64::from(n);
        }
        for (k, inverse_factorial) in [(3, 1.0 / 6.0), (2, 0.5), (1, 1.0), (0, 1.0)] {
            phi[k] = phi[k + 1] * z + inverse_factorial;
        }
    } else {
        phi[0] = z.exp();
        for (k, inverse_factorial) in [(0, 1.0), (1, 1.0), (2, 0.5), (3, 1.0 / 6.0)] {
            phi[k + 1] = (phi[k] - inverse_factorial) / z;
        }
    }
    phi
}

/// φ_k[m + d, m − d] = ½ ∫_{−1}^{1} φ_k'(m + s d) ds, by Gauss–Legendre with eight points; exact to rounding for |d| ≤ ½.
fn mean_derivative(k: usize, mean: Complex<f64>, half_gap: Complex<f64>) -> Complex<f64> {
    const NODES: [(f64, f64); 4] = [
        (0.183_434_642_495_649_8, 0.362_683_783_378_362),
        (0.525_532_409_916_329, 0.313_706_645_877_887_3),
        (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
        (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
    ];
    NODES
        .iter()
        .flat_map(|(s, weight)| [(*s, *weight), (-*s, *weight)])
        .map(|(s, weight)| {
            let phi = phis(mean + half_gap * s);
            (phi[k] - phi[k + 1] * k as f64) * (0.5 * weight)
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::SMatrix;

    /// φ_0 … φ_3 as blocks of exp of an augmented matrix: an independent way to them.
    fn oracle(matrix: &Matrix2<f64>) -> Phis {
        let mut augmented = SMatrix::<f64, 8, 8>::zeros();
        augmented.fixed_view_mut::<2, 2>(0, 0).copy_from(matrix);
        for block in 0..3 {
            augmented.fixed_view_mut::<2, 2>(2 * block, 2 * block + 2).copy_from(&Matrix2::identity());
        }
        let exp = augmented.exp();
        std::array::from_fn(|k| exp.fixed_view::<2, 2>(0, 2 * k).into())
    }

    /// Independent reference: blocks of the exponential of an augmented matrix, by nalgebra.
    #[test]
    fn phis_equal_those_of_the_augmented_exponential() {
        for zeta in [0.0, 0.002, 0.05, 0.5, 0.999, 1.0, 1.0 + 1e-9, 1.3, 5.0] {
            for h in [1e-6, 1e-2, 0.3, 1.0, 1.1, 3.0, 8.0] {
                let omega = 1.0;
                let matrix = Matrix2::new(0.0, h, -h * omega * omega, -2.0 * h * zeta * omega);
                let expected = oracle(&matrix);
                for (k, phi) in oscillator_phis(omega, zeta, h).iter().enumerate() {
                    let error = (phi - expected[k]).amax();
                    assert!(error < 2e-13, "zeta {zeta}, h {h}, phi_{k}: {error:e}");
                }
            }
        }
    }

    /// Closed form: q = (f e^{−sωt} − s e^{−fωt})/(f − s).
    #[test]
    fn the_slow_solution_of_a_strongly_damped_mode_keeps_its_rate() {
        // From rest, q = (f e^{−sωt} − s e^{−fωt})/(f − s), with f, s = ζ ± √(ζ² − 1).
        for (zeta, omega_h) in [(5.0, 30.0), (1e3, 1e2), (1e6, 1e3), (1e6, 1e6)] {
            let fast: f64 = zeta + (zeta * zeta - 1.0_f64).sqrt();
            let expected = fast * (-omega_h / fast).exp() / (fast - fast.recip());
            let phi = oscillator_phis(2.0, zeta, 0.5 * omega_h);
            // 1e-7 off at 1e6 if z₁ is a sum.
            let error = (phi[0][(0, 0)] / expected - 1.0).abs();
            assert!(error < 1e-14, "zeta {zeta}: {error:e}");
        }
    }

    /// Conserved: A φ₁ = φ₀ − 1.
    #[test]
    fn fast_modes_keep_their_static_answer() {
        // φ_1(A) (−A)⁻¹-like limits: A φ_1 = φ_0 − I exactly, at h ω = 1e7.
        let (omega, zeta, h) = (1e9, 0.05, 1e-2);
        let matrix = Matrix2::new(0.0, h, -h * omega * omega, -2.0 * h * zeta * omega);
        let phi = oscillator_phis(omega, zeta, h);
        let scale = Matrix2::new(1.0, 1.0 / omega, omega, 1.0);
        let error = (matrix * phi[1] - (phi[0] - Matrix2::identity())).component_div(&scale);
        assert!(error.amax() < 1e-9, "{error}");
    }
}
