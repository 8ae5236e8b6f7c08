//! Products with constant matrices, which are stored so that the processor reads them from end to end.

use faer::{Mat, MatRef};
use pulp::{Arch, Simd, WithSimd, bytemuck};

use crate::matrix::lists::dot;

/// Rows of a block: its sums stay in registers over all columns.
const HEIGHT: usize = 48;
/// Rows of a group, which fill whole vectors of any processor.
const GROUP: usize = 8;

/// A matrix in blocks of [`HEIGHT`] rows, the last one of fewer, each column by column. Rows are added to a multiple of
/// [`GROUP`], with zeros.
#[derive(Debug, Clone)]
pub(crate) struct BlockedMatrix {
    rows: usize,
    columns: usize,
    /// In one column, which begins at the start of a line of the cache, so that no vector lies across two.
    entries: Mat<f64>,
}

impl BlockedMatrix {
    pub(crate) fn new(matrix: MatRef<'_, f64>) -> Self {
        let columns = matrix.ncols();
        let rows: Vec<_> = (0..matrix.nrows()).map(|i| matrix.row(i)).collect();
        let mut entries = Vec::with_capacity(rows.len().next_multiple_of(GROUP) * columns);
        for block in rows.chunks(HEIGHT) {
            let height = block.len().next_multiple_of(GROUP);
            for j in 0..columns {
                entries.extend((0..height).map(|i| block.get(i).map_or(0.0, |row| row[j])));
            }
        }
        Self { rows: rows.len(), columns, entries: Mat::from_fn(entries.len(), 1, |k, _| entries[k]) }
    }

    /// Number of its entries.
    pub(crate) fn len(&self) -> usize {
        self.rows * self.columns
    }

    /// All its entries.
    pub(crate) fn dense(&self) -> Mat<f64> {
        let mut dense = Mat::zeros(self.rows, self.columns);
        for j in 0..self.columns {
            let unit: Vec<f64> = (0..self.columns).map(|k| f64::from(u8::from(k == j))).collect();
            self.each_block(&unit, |first, rows| {
                rows.iter().enumerate().for_each(|(i, x)| dense[(first + i, j)] = *x);
            });
        }
        dense
    }

    /// xᵀM x of as many rows as columns.
    pub(crate) fn quadratic(&self, x: &[f64]) -> f64 {
        let mut sum = 0.0;
        self.each_block(x, |first, rows| sum += dot(rows, &x[first..]));
        sum
    }

    /// Blocks one after another.
    fn entries(&self) -> &[f64] {
        if self.entries.ncols() > 0 { self.entries.col_as_slice(0) } else { &[] }
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

    /// M x block by block, of the first columns where x is shorter: hands over the first row of each, and what its rows come to.
    pub(crate) fn each_block(&self, x: &[f64], take: impl FnMut(usize, &[f64])) {
        debug_assert!(x.len() <= self.columns, "columns of a product");
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
        let Self { matrix, x, mut take } = self;
        let BlockedMatrix { rows, columns, .. } = matrix;
        let (full, rest) = matrix.entries().split_at(rows / HEIGHT * HEIGHT * columns);
        let mut first = 0;
        for block in full.chunks_exact((HEIGHT * columns).max(1)) {
            match S::F64_LANES {
                4 => take(first, block_product::<S, 12>(simd, block, x).all()),
                8 => take(first, block_product::<S, 6>(simd, block, x).all()),
                _ => take(first, &plain_product(HEIGHT, block, x)),
            }
            first += HEIGHT;
        }
        let count = rows - first;
        let height = count.next_multiple_of(GROUP);
        let mut take = |rows: &[f64]| take(first, &rows[..count]);
        match height / S::F64_LANES {
            0 => {}
            1 => take(block_product::<S, 1>(simd, rest, x).all()),
            2 => take(block_product::<S, 2>(simd, rest, x).all()),
            3 => take(block_product::<S, 3>(simd, rest, x).all()),
            4 => take(block_product::<S, 4>(simd, rest, x).all()),
            5 => take(block_product::<S, 5>(simd, rest, x).all()),
            6 => take(block_product::<S, 6>(simd, rest, x).all()),
            8 => take(block_product::<S, 8>(simd, rest, x).all()),
            10 => take(block_product::<S, 10>(simd, rest, x).all()),
            12 => take(block_product::<S, 12>(simd, rest, x).all()),
            // No vectors, or short ones: more than the registers hold.
            _ => take(&plain_product(height, rest, x)),
        }
    }
}

/// Sums of the rows of a block, in N vectors.
struct Rows<S: Simd, const N: usize>([S::f64s; N]);

impl<S: Simd, const N: usize> Rows<S, N> {
    #[inline(always)]
    fn all(&self) -> &[f64] {
        bytemuck::cast_slice(&self.0)
    }
}

/// The product of a block of N vectors a column.
#[inline(always)]
fn block_product<S: Simd, const N: usize>(simd: S, block: &[f64], x: &[f64]) -> Rows<S, N> {
    let mut sums = [simd.splat_f64s(0.0); N];
    let (vectors, _) = S::as_simd_f64s(block);
    let (columns, _) = vectors.as_chunks::<N>();
    for (column, x) in columns.iter().zip(x) {
        let x = simd.splat_f64s(*x);
        for (sum, entries) in sums.iter_mut().zip(column) {
            *sum = simd.mul_add_e_f64s(*entries, x, *sum);
        }
    }
    Rows(sums)
}

/// The product of a block of `height` rows without vectors.
#[inline(always)]
fn plain_product(height: usize, block: &[f64], x: &[f64]) -> [f64; HEIGHT] {
    let mut sums = [0.0; HEIGHT];
    for (column, x) in block.chunks_exact(height).zip(x) {
        sums.iter_mut().zip(column).for_each(|(sum, entry)| *sum += entry * x);
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Independent reference: the products row by row.
    #[test]
    fn products_equal_the_dense_ones_for_any_size() {
        for (rows, columns) in
            [(1, 1), (7, 3), (8, 2), (29, 29), (48, 5), (50, 4), (95, 6), (261, 29), (147, 49), (120, 40)]
        {
            let matrix = Mat::from_fn(rows, columns, |i, j| ((i * 7 + j * 13) as f64).sin());
            let x: Vec<f64> = (0..columns).map(|j| (j as f64).cos()).collect();
            let start: Vec<f64> = (0..rows).map(|i| i as f64).collect();
            let blocked = BlockedMatrix::new(matrix.as_ref());
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
