//! Lists of numbers as vectors, and as columns of matrices.

use faer::{Mat, MatRef};

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// a + factor · b
pub(crate) fn sum(a: &[f64], factor: f64, b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + factor * b).collect()
}

pub(crate) fn add(a: &mut [f64], factor: f64, b: &[f64]) {
    a.iter_mut().zip(b).for_each(|(a, b)| *a += factor * b);
}

pub(crate) fn column(v: &[f64]) -> MatRef<'_, f64> {
    MatRef::from_column_major_slice(v, v.len(), 1)
}

pub(crate) fn list(matrix: &Mat<f64>, column: usize) -> Vec<f64> {
    matrix.col(column).iter().copied().collect()
}

/// Largest displacement of a node.
pub(crate) fn peak(u: &[f64]) -> f64 {
    u.chunks_exact(3).map(|u| u.iter().map(|u| u * u).sum::<f64>()).fold(0.0, f64::max).sqrt()
}
