//! Products with matrices that are stored column by column in a list.

use faer::MatRef;
use pulp::{Arch, Simd, WithSimd};

/// The entries of a matrix, column by column.
pub(crate) fn columns(matrix: MatRef<'_, f64>) -> Vec<f64> {
    (0..matrix.ncols()).flat_map(|j| (0..matrix.nrows()).map(move |i| matrix[(i, j)])).collect()
}

/// aᵀb, as far as the shorter list goes. Four sums run side by side, so that none waits for the other.
#[inline(always)]
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let length = a.len().min(b.len());
    let (a, a_rest) = a[..length].as_chunks::<4>();
    let (b, b_rest) = b[..length].as_chunks::<4>();
    let mut sums = [0.0; 4];
    for (a, b) in a.iter().zip(b) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a * b;
        }
    }
    for ((sum, a), b) in sums.iter_mut().zip(a_rest).zip(b_rest) {
        *sum += a * b;
    }
    total(sums)
}

/// Σ w_k x_k², as far as the shorter list goes.
pub(crate) fn weighted_squares(weights: &[f64], x: &[f64]) -> f64 {
    let length = weights.len().min(x.len());
    let (weights, weights_rest) = weights[..length].as_chunks::<4>();
    let (x, x_rest) = x[..length].as_chunks::<4>();
    let mut sums = [0.0; 4];
    for (weights, x) in weights.iter().zip(x) {
        for ((sum, weight), x) in sums.iter_mut().zip(weights).zip(x) {
            *sum += weight * (x * x);
        }
    }
    for ((sum, weight), x) in sums.iter_mut().zip(weights_rest).zip(x_rest) {
        *sum += weight * (x * x);
    }
    total(sums)
}

/// The sum of four.
#[inline(always)]
pub(crate) fn total(sums: [f64; 4]) -> f64 {
    (sums[0] + sums[2]) + (sums[1] + sums[3])
}

/// The first `y.len()` rows of M x, for M with `rows` rows, column by column.
pub(crate) fn multiply(matrix: &[f64], rows: usize, x: &[f64], y: &mut [f64]) {
    y.fill(0.0);
    add_product(matrix, rows, x, y);
}

/// Adds the first `y.len()` rows of M x to y, for M with `rows` rows, column by column.
pub(crate) fn add_product(matrix: &[f64], rows: usize, x: &[f64], y: &mut [f64]) {
    Arch::new().dispatch(Product { matrix, rows: rows.max(1), x, y });
}

/// A product, in the widest vectors that the processor has.
struct Product<'a> {
    matrix: &'a [f64],
    rows: usize,
    x: &'a [f64],
    y: &'a mut [f64],
}

impl WithSimd for Product<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { matrix, rows, x, y } = self;
        let length = y.len();
        if length < S::F64_LANES {
            for (column, x) in matrix.chunks_exact(rows).zip(x) {
                y.iter_mut().zip(column).for_each(|(y, entry)| *y += entry * x);
            }
            return;
        }
        // The last vector ends with the last row. Where the rows fill no whole number of vectors, it has rows of the one
        // before once more, and begins with what y has there now.
        let last = length - S::F64_LANES;
        let ([end], _) = S::as_simd_f64s(&y[last..]) else { return };
        let end = (last, *end);
        let mut row = 0;
        while row + 8 * S::F64_LANES <= last {
            add_rows::<S, 8>(simd, matrix, rows, row, x, y);
            row += 8 * S::F64_LANES;
        }
        match (last - row).div_ceil(S::F64_LANES) {
            0 => add_last_rows::<S, 0>(simd, matrix, rows, row, x, end, y),
            1 => add_last_rows::<S, 1>(simd, matrix, rows, row, x, end, y),
            2 => add_last_rows::<S, 2>(simd, matrix, rows, row, x, end, y),
            3 => add_last_rows::<S, 3>(simd, matrix, rows, row, x, end, y),
            4 => add_last_rows::<S, 4>(simd, matrix, rows, row, x, end, y),
            5 => add_last_rows::<S, 5>(simd, matrix, rows, row, x, end, y),
            6 => add_last_rows::<S, 6>(simd, matrix, rows, row, x, end, y),
            7 => add_last_rows::<S, 7>(simd, matrix, rows, row, x, end, y),
            _ => add_last_rows::<S, 8>(simd, matrix, rows, row, x, end, y),
        }
    }
}

/// Adds the rows of a product from `row` on, as many as fill N vectors, whose sums stay in registers over all columns.
#[inline(always)]
fn add_rows<S: Simd, const N: usize>(simd: S, matrix: &[f64], rows: usize, row: usize, x: &[f64], y: &mut [f64]) {
    let (y, _) = S::as_mut_simd_f64s(&mut y[row..]);
    let Some(y) = y.first_chunk_mut::<N>() else { return };
    let mut sums = *y;
    for (column, x) in matrix.chunks_exact(rows).zip(x) {
        add_column(simd, column, row, simd.splat_f64s(*x), &mut sums);
    }
    *y = sums;
}

/// The same, and the last vector, with its first row and its sums so far.
#[inline(always)]
fn add_last_rows<S: Simd, const N: usize>(
    simd: S,
    matrix: &[f64],
    rows: usize,
    row: usize,
    x: &[f64],
    (last, end): (usize, S::f64s),
    y: &mut [f64],
) {
    let Some(before) = S::as_mut_simd_f64s(&mut y[row..]).0.first_chunk_mut::<N>() else { return };
    let (mut sums, mut end) = (*before, [end]);
    for (column, x) in matrix.chunks_exact(rows).zip(x) {
        let x = simd.splat_f64s(*x);
        add_column(simd, column, row, x, &mut sums);
        add_column(simd, column, last, x, &mut end);
    }
    *before = sums;
    if let ([last], _) = S::as_mut_simd_f64s(&mut y[last..]) {
        *last = end[0];
    }
}

#[inline(always)]
fn add_column<S: Simd, const N: usize>(simd: S, column: &[f64], row: usize, x: S::f64s, sums: &mut [S::f64s; N]) {
    let (entries, _) = S::as_simd_f64s(&column[row..][..N * S::F64_LANES]);
    for (sum, entries) in sums.iter_mut().zip(entries) {
        *sum = simd.mul_add_e_f64s(*entries, x, *sum);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Independent reference: the sum term by term.
    #[test]
    fn weighted_squares_are_summed_to_the_last() {
        for length in 0..13_usize {
            let list = |phase: f64| -> Vec<f64> { (0..length).map(|k| (k as f64 + phase).sin()).collect() };
            let (weights, x) = (list(0.1), list(0.7));
            let expected: f64 = weights.iter().zip(&x).map(|(w, x)| w * x * x).sum();
            assert!((weighted_squares(&weights, &x) - expected).abs() < 1e-14, "{length}");
        }
    }

    /// Independent reference: the products row by row.
    #[test]
    fn products_of_any_length_have_all_their_rows() {
        let x = [0.3, -1.1, 2.0];
        for rows in 1..=130_usize {
            let matrix: Vec<f64> = (0..3 * rows).map(|i| (i as f64).sin()).collect();
            for asked in [rows, rows.div_ceil(2)] {
                let mut y = vec![f64::NAN; asked];
                multiply(&matrix, rows, &x, &mut y);
                for (i, y) in y.iter().enumerate() {
                    let expected: f64 = (0..3).map(|j| matrix[j * rows + i] * x[j]).sum();
                    assert!((y - expected).abs() < 1e-14, "row {i} of {asked}, {rows} in all: {y} for {expected}");
                }
            }
        }
    }
}
