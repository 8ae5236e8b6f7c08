//! Symmetric 3×3 matrices, entry by entry.

use nalgebra::Matrix3;

/// Adds to the entries ij and ji, which are one on the diagonal.
pub(crate) fn add(matrix: &mut Matrix3<f64>, (i, j): (usize, usize), entry: f64) {
    matrix[(i, j)] += entry;
    if i != j {
        matrix[(j, i)] += entry;
    }
}
