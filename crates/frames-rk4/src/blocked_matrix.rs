//! Products with constant matrices, which are stored so that the processor reads them from end to end.

use faer::{Mat, MatRef};
use pulp::{Arch, Simd, WithSimd, bytemuck};

/// Rows of a block: its sums stay in registers over all columns.
const HEIGHT: usize = 48;
/// As many rows of two products.
const HALF: usize = HEIGHT / 2;
/// Numbers that the fastest cache holds besides all else: a matrix of fewer is read twice sooner than it serves two lists.
const IN_CACHE: usize = 2048;
/// Rows come in groups of so many, which fill whole vectors of any processor.
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
        Self { rows: rows.len(), columns, entries: Mat::from_fn(entries.len(), 1, |k, _| entries[k]) }
    }

    /// Blocks one after another.
    fn entries(&self) -> &[f64] {
        if self.entries.ncols() > 0 { self.entries.col_as_slice(0) } else { &[] }
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

    /// y₁ += M x₁ and y₂ = M x₂: a large matrix is read once for both.
    pub(crate) fn two_products(&self, x: [&[f64]; 2], y: [&mut [f64]; 2]) {
        debug_assert!(x.iter().all(|x| x.len() == self.columns), "columns of a product");
        debug_assert!(y.iter().all(|y| y.len() == self.rows), "rows of a product");
        if self.entries.nrows() < IN_CACHE {
            let ([x1, x2], [y1, y2]) = (x, y);
            self.add_product(x1, y1);
            return self.multiply(x2, y2);
        }
        Arch::new().dispatch(TwoProducts { matrix: self, x, y });
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
            // No vectors, or short ones: more than the registers hold.
            _ => take(&plain_product(height, rest, x)),
        }
    }
}

/// Two products with one matrix, in the widest vectors that the processor has.
struct TwoProducts<'a> {
    matrix: &'a BlockedMatrix,
    x: [&'a [f64]; 2],
    y: [&'a mut [f64]; 2],
}

impl WithSimd for TwoProducts<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { matrix, x, y: [y1, y2] } = self;
        let (columns, mut entries) = (matrix.columns, matrix.entries());
        for (y1, y2) in y1.chunks_mut(HEIGHT).zip(y2.chunks_mut(HEIGHT)) {
            let height = y1.len().next_multiple_of(GROUP);
            let Some((block, rest)) = entries.split_at_checked(height * columns) else { return };
            entries = rest;
            let mut first = 0;
            while first < height {
                // The sums of as many rows, twice, stay in registers.
                let rows = (height - first).min(HALF);
                let ends = [y1.len(), y2.len()].map(|length| length.min(first + rows));
                let y = [&mut y1[first.min(ends[0])..ends[0]], &mut y2[first.min(ends[1])..ends[1]]];
                match rows / S::F64_LANES {
                    2 => two_products::<S, 2>(simd, block, height, first, x, y),
                    4 => two_products::<S, 4>(simd, block, height, first, x, y),
                    6 => two_products::<S, 6>(simd, block, height, first, x, y),
                    _ => {
                        y[1].fill(0.0);
                        for (x, y) in x.iter().zip(y) {
                            for (column, x) in block.chunks_exact(height).zip(*x) {
                                y.iter_mut().zip(&column[first..][..rows]).for_each(|(y, entry)| *y += entry * x);
                            }
                        }
                    }
                }
                first += HALF;
            }
        }
    }
}

/// Two products with the rows from `first` on of a block of `height` rows, N vectors a column.
#[inline(always)]
fn two_products<S: Simd, const N: usize>(
    simd: S,
    block: &[f64],
    height: usize,
    first: usize,
    [x1, x2]: [&[f64]; 2],
    y: [&mut [f64]; 2],
) {
    let mut sums = [[simd.splat_f64s(0.0); N]; 2];
    for ((column, x1), x2) in block.chunks_exact(height).zip(x1).zip(x2) {
        let Some(column) = S::as_simd_f64s(&column[first..]).0.first_chunk::<N>() else { return };
        let [x1, x2] = [simd.splat_f64s(*x1), simd.splat_f64s(*x2)];
        for k in 0..N {
            sums[0][k] = simd.mul_add_e_f64s(column[k], x1, sums[0][k]);
            sums[1][k] = simd.mul_add_e_f64s(column[k], x2, sums[1][k]);
        }
    }
    let ([y1, y2], sums): (_, [&[f64]; 2]) = (y, sums.each_ref().map(|sums| bytemuck::cast_slice(sums)));
    y1.iter_mut().zip(sums[0]).for_each(|(y, sum)| *y += sum);
    y2.iter_mut().zip(sums[1]).for_each(|(y, sum)| *y = *sum);
}

/// What the rows of a block come to, in N vectors.
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

    #[test]
    fn products_equal_the_dense_ones_for_any_size() {
        for (rows, columns) in
            [(1, 1), (7, 3), (8, 2), (29, 29), (48, 5), (50, 4), (95, 6), (261, 29), (147, 49), (120, 40)]
        {
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
                let mut two = [start.clone(), vec![f64::NAN; rows]];
                let twice: Vec<f64> = x.iter().map(|x| 2.0 * x).collect();
                let [first, second] = &mut two;
                blocked.two_products([&x, &twice], [first, second]);
                for i in 0..rows {
                    let expected: f64 = (0..columns).map(|j| matrix[(i, j)] * x[j]).sum();
                    assert!((product[i] - expected).abs() < 1e-13, "{rows} x {columns}");
                    assert!((sum[i] - start[i] - expected).abs() < 1e-13, "{rows} x {columns}");
                    assert!((two[0][i] - start[i] - expected).abs() < 1e-13, "{rows} x {columns}");
                    assert!((two[1][i] - 2.0 * expected).abs() < 1e-13, "{rows} x {columns}");
                }
            }
        }
    }
}
