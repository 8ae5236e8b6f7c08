//! Products with matrices that are stored column by column in a list.

use faer::MatRef;
use pulp::{Arch, Simd, WithSimd};

/// The entries of a matrix, column by column.
pub(crate) fn columns(matrix: MatRef<'_, f64>) -> Vec<f64> {
    (0..matrix.ncols()).flat_map(|j| (0..matrix.nrows()).map(move |i| matrix[(i, j)])).collect()
}

/// aᵀb, as far as the shorter list goes. Four sums run side by side, so that none waits for the other.
#[inline]
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
        // Where the rows fill no whole number of vectors, the last vector has rows of the one before once more.
        let last = length - S::F64_LANES;
        let end = match S::as_simd_f64s(&y[last..]) {
            ([start], _) if !length.is_multiple_of(S::F64_LANES) => {
                let [sum] = add_rows(simd, matrix, rows, last, x, [*start]);
                Some(sum)
            }
            _ => None,
        };
        let (vectors, _) = S::as_mut_simd_f64s(y);
        // The sums of a block stay in registers over all columns.
        let (blocks_of_8, vectors) = vectors.as_chunks_mut::<8>();
        let (blocks_of_4, vectors) = vectors.as_chunks_mut::<4>();
        let (blocks_of_2, vectors) = vectors.as_chunks_mut::<2>();
        let (blocks_of_1, _) = vectors.as_chunks_mut::<1>();
        let row = add_blocks(simd, matrix, rows, 0, x, blocks_of_8);
        let row = add_blocks(simd, matrix, rows, row, x, blocks_of_4);
        let row = add_blocks(simd, matrix, rows, row, x, blocks_of_2);
        add_blocks(simd, matrix, rows, row, x, blocks_of_1);
        if let (Some(sum), ([end], _)) = (end, S::as_mut_simd_f64s(&mut y[last..])) {
            *end = sum;
        }
    }
}

/// Adds the rows of a product from `row` on to blocks of N vectors. Returns the row after them.
#[inline(always)]
fn add_blocks<S: Simd, const N: usize>(
    simd: S,
    matrix: &[f64],
    rows: usize,
    mut row: usize,
    x: &[f64],
    blocks: &mut [[S::f64s; N]],
) -> usize {
    for block in blocks {
        *block = add_rows(simd, matrix, rows, row, x, *block);
        row += N * S::F64_LANES;
    }
    row
}

/// Adds the rows of a product from `first`, as many as fill N vectors.
#[inline(always)]
fn add_rows<S: Simd, const N: usize>(
    simd: S,
    matrix: &[f64],
    rows: usize,
    first: usize,
    x: &[f64],
    mut sums: [S::f64s; N],
) -> [S::f64s; N] {
    for (column, x) in matrix.chunks_exact(rows).zip(x) {
        let (entries, _) = S::as_simd_f64s(&column[first..][..N * S::F64_LANES]);
        let x = simd.splat_f64s(*x);
        for (sum, entries) in sums.iter_mut().zip(entries) {
            *sum = simd.mul_add_e_f64s(*entries, x, *sum);
        }
    }
    sums
}
