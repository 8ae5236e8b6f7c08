//! Symmetric 3×3 matrices, entry by entry.

use nalgebra::{Matrix3, Vector3};
use reduced_body::ReducedBody;

/// Adds to the entries ij and ji, which are one on the diagonal.
pub(crate) fn add(matrix: &mut Matrix3<f64>, (i, j): (usize, usize), entry: f64) {
    matrix[(i, j)] += entry;
    if i != j {
        matrix[(j, i)] += entry;
    }
}

/// The matrix with these entries at [`ReducedBody::PAIRS`].
#[inline(always)]
pub(crate) fn of_pairs(entries: &[f64; 6]) -> Matrix3<f64> {
    let mut matrix = Matrix3::zeros();
    for (pair, entry) in ReducedBody::PAIRS.into_iter().zip(entries) {
        add(&mut matrix, pair, *entry);
    }
    matrix
}

/// A⁻¹ x by cofactors; not finite where A is singular.
pub(crate) fn solve(a: &Matrix3<f64>, x: &Vector3<f64>) -> Vector3<f64> {
    let (xx, yy, zz) = (a[(0, 0)], a[(1, 1)], a[(2, 2)]);
    let (xy, xz, yz) = (a[(0, 1)], a[(0, 2)], a[(1, 2)]);
    let first = Vector3::new(yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy);
    let second = Vector3::new(first.y, xx * zz - xz * xz, xy * xz - xx * yz);
    let third = Vector3::new(first.z, second.z, xx * yy - xy * xy);
    let inverse = (xx * first.x + xy * first.y + xz * first.z).recip();
    Vector3::new(first.dot(x), second.dot(x), third.dot(x)) * inverse
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Conserved: A x = b.
    #[test]
    fn the_solution_solves_and_a_singular_matrix_has_none() {
        let a = Matrix3::new(2.0, -0.3, 0.7, -0.3, 1.5, 0.2, 0.7, 0.2, 3.0);
        let x = Vector3::new(1.0, -2.0, 0.5);
        assert!((a * solve(&a, &x) - x).norm() < 1e-15);
        let singular = Matrix3::new(1.0, 2.0, 0.0, 2.0, 4.0, 0.0, 0.0, 0.0, 1.0);
        assert!(!solve(&singular, &x).sum().is_finite());
    }
}
