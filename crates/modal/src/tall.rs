//! Products of tall matrices: N rows, few columns.
//!
//! The rows are cut at fixed places and sums are taken in a fixed order, so the result does not depend, to the last
//! bit, on the number of threads.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, MatRef, Par};
use rayon::prelude::*;

/// Rows that one task computes.
const ROWS: usize = 4096;

/// AᵀB.
pub(crate) fn inner(a: MatRef<'_, f64>, b: MatRef<'_, f64>) -> Mat<f64> {
    let zero = || Mat::zeros(a.ncols(), b.ncols());
    let parts: Vec<Mat<f64>> = a
        .par_row_chunks(ROWS)
        .zip(b.par_row_chunks(ROWS))
        .map(|(a, b)| {
            let mut part = zero();
            matmul(part.as_mut(), Accum::Replace, a.transpose(), b, 1.0, Par::Seq);
            part
        })
        .collect();
    parts.into_iter().fold(zero(), |sum, part| sum + part)
}

/// Y = A·H, or Y += `factor`·A·H.
pub(crate) fn multiply(y: MatMut<'_, f64>, beta: Accum, a: MatRef<'_, f64>, h: MatRef<'_, f64>, factor: f64) {
    y.par_row_chunks_mut(ROWS).zip(a.par_row_chunks(ROWS)).for_each(|(y, a)| matmul(y, beta, a, h, factor, Par::Seq));
}

/// A·H.
pub(crate) fn product(a: MatRef<'_, f64>, h: MatRef<'_, f64>) -> Mat<f64> {
    let mut y = Mat::zeros(a.nrows(), h.ncols());
    multiply(y.as_mut(), Accum::Replace, a, h, 1.0);
    y
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_in_pieces_equal_the_whole() {
        let n = 2 * ROWS + 77;
        let a = Mat::from_fn(n, 5, |i, j| ((i * 7 + j * 13) as f64).cos());
        let b = Mat::from_fn(n, 3, |i, j| ((i * 3 + j * 11) as f64).sin());
        let h = inner(a.as_ref(), b.as_ref());
        assert!((&h - a.transpose() * &b).norm_max() < 1e-10);
        let expected = &b - &a * &h * faer::Scale(0.5);
        let mut y = b.clone();
        multiply(y.as_mut(), Accum::Add, a.as_ref(), h.as_ref(), -0.5);
        assert!((&y - &expected).norm_max() < 1e-9);
        assert!((product(a.as_ref(), h.as_ref()) - &a * &h).norm_max() < 1e-9);
    }
}
