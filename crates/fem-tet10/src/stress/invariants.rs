//! Invariants of a stress.

use nalgebra::{Matrix3, SymmetricEigen};

/// The von Mises stress of the components xx, yy, zz, xy, yz, zx.
pub fn von_mises(stress: &[f64; 6]) -> f64 {
    let [xx, yy, zz, xy, yz, zx] = *stress;
    let normal = (xx - yy).powi(2) + (yy - zz).powi(2) + (zz - xx).powi(2);
    (0.5 * normal + 3.0 * (xy * xy + yz * yz + zx * zx)).sqrt()
}

/// The principal stresses of the components xx, yy, zz, xy, yz, zx, the largest first.
pub fn principal_stresses(stress: &[f64; 6]) -> [f64; 3] {
    let [xx, yy, zz, xy, yz, zx] = *stress;
    let mut principal: [f64; 3] =
        SymmetricEigen::new(Matrix3::new(xx, xy, zx, xy, yy, yz, zx, yz, zz)).eigenvalues.into();
    principal.sort_by(|a, b| b.total_cmp(a));
    principal
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed form: von Mises stress and principal stresses of tension, pressure and shear.
    #[test]
    fn tension_shear_and_pressure_are_what_they_are_in_books() {
        assert_eq!(von_mises(&[-7.0, 0.0, 0.0, 0.0, 0.0, 0.0]), 7.0);
        assert_eq!(von_mises(&[5.0, 5.0, 5.0, 0.0, 0.0, 0.0]), 0.0);
        for shear in [[0.0, 0.0, 0.0, 2.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0, -2.0, 0.0], [0.0, 0.0, 0.0, 0.0, 0.0, 2.0]] {
            assert!((von_mises(&shear) - 12.0_f64.sqrt()).abs() < 1e-15);
            let principal = principal_stresses(&shear);
            assert!(principal.iter().zip([2.0, 0.0, -2.0]).all(|(found, true_one)| (found - true_one).abs() < 1e-14));
        }
    }

    /// Conserved: the trace and the von Mises stress do not depend on the axes.
    #[test]
    fn the_von_mises_stress_is_that_of_the_principal_stresses() {
        let stress = [3.0, -1.0, 4.0, 1.5, -2.5, 0.7];
        let [a, b, c] = principal_stresses(&stress);
        assert!(a >= b && b >= c);
        assert!((a + b + c - 6.0).abs() < 1e-13);
        assert!((von_mises(&[a, b, c, 0.0, 0.0, 0.0]) / von_mises(&stress) - 1.0).abs() < 1e-14);
    }
}
