//! Products with constant matrices, which are stored so that the processor reads them from end to end.

use faer::MatRef;
use pulp::{Arch, Simd, WithSimd, bytemuck};

/// Rows of a block: its sums stay in registers over all columns.
const HEIGHT: usize = 48;
/// Rows come in groups of so many, which fill whole vectors of any processor.
const GROUP: usize = 8;

/// A matrix in blocks of [`HEIGHT`] rows, the last one of fewer, each column by column. Rows are added to a multiple of
/// [`GROUP`], with zeros.
#[derive(Debug, Clone, Default)]
pub(crate) struct BlockedMatrix {
    rows: usize,
    columns: usize,
    entries: Vec<f64>,
}

impl BlockedMatrix {
    pub(crate) fn new(matrix: MatRef<'_, f64>) -> Self {
        Self::below_one_another(&[matrix])
    }

    /// Matrices with as many columns each, one below another.
    pub(crate) fn below_one_another(matrices: &[MatRef<'_, f64>]) -> Self {
        let columns = matrices.first().map_or(0, |matrix| matrix.ncols());
        let rows: Vec<_> = matrices.iter().flat_map(|m| (0..m.nrows()).map(move |i| m.row(i))).collect();
        let mut entries = Vec::with_capacity(rows.len().next_multiple_of(GROUP) * columns);
        for block in rows.chunks(HEIGHT) {
            let height = block.len().next_multiple_of(GROUP);
            for j in 0..columns {
                entries.extend((0..height).map(|i| block.get(i).map_or(0.0, |row| row[j])));
            }
        }
        Self { rows: rows.len(), columns, entries }
    }

    /// Numbers of the matrix itself.
    pub(crate) fn len(&self) -> usize {
        self.rows * self.columns
    }

    /// y = M x
    pub(crate) fn multiply(&self, x: &[f64], y: &mut [f64]) {
        debug_assert_eq!(y.len(), self.rows, "rows of a product");
        self.each_block(x, |first, rows| y[first..first + rows.len()].copy_from_slice(rows));
    }

    /// y += M x
    pub(crate) fn add_product(&self, x: &[f64], y: &mut [f64]) {
        debug_assert_eq!(y.len(), self.rows, "rows of a product");
        self.each_block(x, |first, rows| y[first..].iter_mut().zip(rows).for_each(|(y, row)| *y += row));
    }

    /// M x block by block: hands over the first row of each, and what its rows come to.
    pub(crate) fn each_block(&self, x: &[f64], take: impl FnMut(usize, &[f64])) {
        debug_assert_eq!(x.len(), self.columns, "columns of a product");
        Arch::new().dispatch(Product { matrix: self, x, take });
    }
}

/// A product, in the widest vectors that the processor has.
struct Product<'a, F> {
    matrix: &'a BlockedMatrix,
    x: &'a [f64],
    take: F,
}

impl<F: FnMut(usize, &[f64])> WithSimd for Product<'_, F> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { matrix: BlockedMatrix { rows, columns, entries }, x, mut take } = self;
        let mut entries = &entries[..];
        for first in (0..*rows).step_by(HEIGHT) {
            let count = HEIGHT.min(rows - first);
            let height = count.next_multiple_of(GROUP);
            let Some((block, rest)) = entries.split_at_checked(height * columns) else { return };
            entries = rest;
            let mut sums = [0.0; HEIGHT];
            match height / S::F64_LANES {
                1 => block_product::<S, 1>(simd, block, x, &mut sums),
                2 => block_product::<S, 2>(simd, block, x, &mut sums),
                3 => block_product::<S, 3>(simd, block, x, &mut sums),
                4 => block_product::<S, 4>(simd, block, x, &mut sums),
                5 => block_product::<S, 5>(simd, block, x, &mut sums),
                6 => block_product::<S, 6>(simd, block, x, &mut sums),
                8 => block_product::<S, 8>(simd, block, x, &mut sums),
                10 => block_product::<S, 10>(simd, block, x, &mut sums),
                12 => block_product::<S, 12>(simd, block, x, &mut sums),
                // No vectors, or short ones: more than the registers hold.
                _ => {
                    for (column, x) in block.chunks_exact(height).zip(x) {
                        sums.iter_mut().zip(column).for_each(|(sum, entry)| *sum += entry * x);
                    }
                }
            }
            take(first, &sums[..count]);
        }
    }
}

/// The product of a block of N vectors a column.
#[inline(always)]
fn block_product<S: Simd, const N: usize>(simd: S, block: &[f64], x: &[f64], out: &mut [f64; HEIGHT]) {
    let mut sums = [simd.splat_f64s(0.0); N];
    let (vectors, _) = S::as_simd_f64s(block);
    let (columns, _) = vectors.as_chunks::<N>();
    for (column, x) in columns.iter().zip(x) {
        let x = simd.splat_f64s(*x);
        for (sum, entries) in sums.iter_mut().zip(column) {
            *sum = simd.mul_add_e_f64s(*entries, x, *sum);
        }
    }
    out.iter_mut().zip(bytemuck::cast_slice::<_, f64>(&sums)).for_each(|(out, sum)| *out = *sum);
}

#[cfg(test)]
mod tests {
    use faer::Mat;

    use super::*;

    #[test]
    fn products_equal_the_dense_ones_for_any_size() {
        for (rows, columns) in [(1, 1), (7, 3), (8, 2), (29, 29), (48, 5), (50, 4), (95, 6), (261, 29)] {
            let matrix = Mat::from_fn(rows, columns, |i, j| ((i * 7 + j * 13) as f64).sin());
            let x: Vec<f64> = (0..columns).map(|j| (j as f64).cos()).collect();
            let start: Vec<f64> = (0..rows).map(|i| i as f64).collect();
            let upper = rows / 2;
            let parts = [matrix.get(..upper, ..), matrix.get(upper.., ..)];
            for blocked in [BlockedMatrix::new(matrix.as_ref()), BlockedMatrix::below_one_another(&parts)] {
                assert_eq!(blocked.len(), rows * columns);
                let (mut product, mut sum) = (vec![f64::NAN; rows], start.clone());
                blocked.multiply(&x, &mut product);
                blocked.add_product(&x, &mut sum);
                for i in 0..rows {
                    let expected: f64 = (0..columns).map(|j| matrix[(i, j)] * x[j]).sum();
                    assert!((product[i] - expected).abs() < 1e-13, "{rows} x {columns}");
                    assert!((sum[i] - start[i] - expected).abs() < 1e-13, "{rows} x {columns}");
                }
            }
        }
    }
}
