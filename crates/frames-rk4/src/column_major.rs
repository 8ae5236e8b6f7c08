//! Products with matrices that are stored column by column in a list.

use faer::MatRef;
use pulp::{Arch, Simd, WithSimd};

/// The entries of a matrix, column by column.
pub(crate) fn columns(matrix: MatRef<'_, f64>) -> Vec<f64> {
    (0..matrix.ncols()).flat_map(|j| (0..matrix.nrows()).map(move |i| matrix[(i, j)])).collect()
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The first `y.len()` rows of M x, for M with `rows` rows, column by column.
pub(crate) fn multiply(matrix: &[f64], rows: usize, x: &[f64], y: &mut [f64]) {
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
        let (vectors, rest) = S::as_mut_simd_f64s(y);
        // The sums of a block stay in registers over all columns.
        let (blocks, vectors) = vectors.as_chunks_mut::<8>();
        let (small_blocks, vectors) = vectors.as_chunks_mut::<2>();
        let mut row = 0;
        for block in blocks {
            *block = rows_of(simd, matrix, rows, row, x);
            row += 8 * S::F64_LANES;
        }
        for block in small_blocks {
            *block = rows_of(simd, matrix, rows, row, x);
            row += 2 * S::F64_LANES;
        }
        for vector in vectors {
            [*vector] = rows_of(simd, matrix, rows, row, x);
            row += S::F64_LANES;
        }
        if !rest.is_empty() {
            let mut sum = simd.splat_f64s(0.0);
            for (column, x) in matrix.chunks_exact(rows).zip(x) {
                let entries = simd.partial_load_f64s(&column[row..][..rest.len()]);
                sum = simd.mul_add_e_f64s(entries, simd.splat_f64s(*x), sum);
            }
            simd.partial_store_f64s(rest, sum);
        }
    }
}

/// The rows of a product from `first`, as many as fill N vectors.
#[inline(always)]
fn rows_of<S: Simd, const N: usize>(simd: S, matrix: &[f64], rows: usize, first: usize, x: &[f64]) -> [S::f64s; N] {
    let mut sums = [simd.splat_f64s(0.0); N];
    for (column, x) in matrix.chunks_exact(rows).zip(x) {
        let (column, _) = S::as_simd_f64s(&column[first..][..N * S::F64_LANES]);
        let x = simd.splat_f64s(*x);
        for (sum, entries) in sums.iter_mut().zip(column) {
            *sum = simd.mul_add_e_f64s(*entries, x, *sum);
        }
    }
    sums
}
