//! Products with matrices that are stored column by column in a list.

use faer::MatRef;

/// The entries of a matrix, column by column.
pub(crate) fn columns(matrix: MatRef<'_, f64>) -> Vec<f64> {
    (0..matrix.ncols()).flat_map(|j| (0..matrix.nrows()).map(move |i| matrix[(i, j)])).collect()
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// y = M x for M with `rows` rows, column by column.
pub(crate) fn multiply(matrix: &[f64], rows: usize, x: &[f64], y: &mut [f64]) {
    y.fill(0.0);
    if rows == 0 {
        return;
    }
    for (column, x) in matrix.chunks_exact(rows).zip(x) {
        for (y, m) in y.iter_mut().zip(column) {
            *y += m * x;
        }
    }
}

/// The first `y.len()` rows of M x.
pub(crate) fn multiply_top(matrix: &[f64], rows: usize, x: &[f64], y: &mut [f64]) {
    y.fill(0.0);
    if rows == 0 {
        return;
    }
    let top = y.len();
    for (column, x) in matrix.chunks_exact(rows).zip(x) {
        for (y, m) in y.iter_mut().zip(&column[..top]) {
            *y += m * x;
        }
    }
}
