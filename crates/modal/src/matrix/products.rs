//! Products of a sparse symmetric matrix with a block of vectors.
//!
//! The block is repacked so that the numbers of a row lie side by side: the matrix is then read once for
//! [`WIDTH`] vectors and each of its entries meets one contiguous run.

use faer::reborrow::ReborrowMut;
use faer::sparse::SparseColMatRef;
use faer::{Mat, MatMut, MatRef};
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use crate::matrix::packed_rows::{add_multiple, prefetch};
use crate::matrix::row_chunks::row_chunks_mut;

/// Vectors handled in one pass over the matrix.
pub(crate) const WIDTH: usize = 8;
/// Neighbours of a node whose rows are asked for ahead of their use.
const AHEAD: usize = 12;
/// Nodes that one task computes.
pub(crate) const NODES_PER_TASK: usize = 128;

/// One row of a packed block.
pub(crate) type Packed = [f64; WIDTH];

/// A matrix by the rows of its nodes.
pub(crate) trait NodeRows: Sync {
    /// The three rows of a node in the product with a packed block.
    fn product<S: Simd>(&self, simd: S, node: usize, packed: &[Packed]) -> [Packed; 3];
}

/// A·X for a symmetric A (3n×3n) with both triangles stored.
pub(crate) fn symmetric_product(a: SparseColMatRef<'_, usize, f64>, x: MatRef<'_, f64>) -> Mat<f64> {
    let mut y = Mat::zeros(x.nrows(), x.ncols());
    symmetric_product_into(a, x, y.as_mut(), &mut Vec::new());
    y
}

/// Y = A·X for the same; `packed` is scratch.
pub(crate) fn symmetric_product_into(
    a: SparseColMatRef<'_, usize, f64>,
    x: MatRef<'_, f64>,
    y: MatMut<'_, f64>,
    packed: &mut Vec<Packed>,
) {
    blocked(x, y, packed, &Symmetric { start: a.symbolic().col_ptr(), rows: a.symbolic().row_idx(), values: a.val() });
}

/// A symmetric matrix with both triangles stored: a column is a row.
struct Symmetric<'a> {
    start: &'a [usize],
    rows: &'a [usize],
    values: &'a [f64],
}

impl Symmetric<'_> {
    #[inline(always)]
    fn column(&self, column: usize) -> (&[usize], &[f64]) {
        let entries = self.start[column]..self.start[column + 1];
        (&self.rows[entries.clone()], &self.values[entries])
    }
}

impl NodeRows for Symmetric<'_> {
    #[inline(always)]
    fn product<S: Simd>(&self, simd: S, node: usize, packed: &[Packed]) -> [Packed; 3] {
        let mut sums = [[0.0; WIDTH]; 3];
        let [(rows, x), (rows_y, y), (rows_z, z)] =
            [self.column(3 * node), self.column(3 * node + 1), self.column(3 * node + 2)];
        if rows == rows_y && rows == rows_z {
            let (y, z) = (&y[..x.len()], &z[..x.len()]);
            for (entry, row) in rows.iter().enumerate().take(x.len()) {
                for (sum, values) in sums.iter_mut().zip([x, y, z]) {
                    add_multiple(simd, sum, values[entry], &packed[*row]);
                }
            }
        } else {
            for (axis, sum) in sums.iter_mut().enumerate() {
                let (rows, values) = self.column(3 * node + axis);
                for (row, value) in rows.iter().zip(values) {
                    add_multiple(simd, sum, *value, &packed[*row]);
                }
            }
        }
        sums
    }
}

/// A symmetric matrix (3n×3n) of 3×3 blocks, by pairs of nodes in compressed columns.
#[derive(Clone, Copy)]
pub(crate) struct NodeBlocks<'a> {
    pub start: &'a [usize],
    pub nodes: &'a [u32],
    /// The three columns of each node, in each the rows of the nodes that it is coupled to.
    pub values: &'a [f64],
}

impl NodeRows for NodeBlocks<'_> {
    #[inline(always)]
    fn product<S: Simd>(&self, simd: S, node: usize, packed: &[Packed]) -> [Packed; 3] {
        let mut sums = [[0.0; WIDTH]; 3];
        let range = self.start[node]..self.start[node + 1];
        let nodes = &self.nodes[range.clone()];
        let values = &self.values[9 * range.start..9 * range.end];
        let (x, yz) = values.split_at(3 * nodes.len());
        let (y, z) = yz.split_at(3 * nodes.len());
        let (x, y, z) = (x.as_chunks::<3>().0, y.as_chunks::<3>().0, z.as_chunks::<3>().0);
        for (((other, x), y), z) in nodes.iter().zip(x).zip(y).zip(z) {
            let first = 3 * *other as usize;
            for (axis, row) in packed[first..first + 3].iter().enumerate() {
                for (sum, values) in sums.iter_mut().zip([x, y, z]) {
                    add_multiple(simd, sum, values[axis], row);
                }
            }
        }
        sums
    }
}

/// Y = A·X for a matrix of blocks; `packed` is scratch.
pub(crate) fn blocks_product(a: NodeBlocks<'_>, x: MatRef<'_, f64>, y: MatMut<'_, f64>, packed: &mut Vec<Packed>) {
    blocked(x, y, packed, &a);
}

/// Y = (A ⊗ I₃)·X for a symmetric matrix A over nodes, in compressed rows. `packed` is scratch.
pub(crate) fn nodal_product(
    start: &[usize],
    nodes: &[u32],
    values: &[f64],
    x: MatRef<'_, f64>,
    y: MatMut<'_, f64>,
    packed: &mut Vec<Packed>,
) {
    blocked(x, y, packed, &Nodal { start, nodes, values });
}

/// A ⊗ I₃ for a symmetric matrix A over nodes.
struct Nodal<'a> {
    start: &'a [usize],
    nodes: &'a [u32],
    values: &'a [f64],
}

impl NodeRows for Nodal<'_> {
    #[inline(always)]
    fn product<S: Simd>(&self, simd: S, node: usize, packed: &[Packed]) -> [Packed; 3] {
        let mut sums = [[0.0; WIDTH]; 3];
        let range = self.start[node]..self.start[node + 1];
        for (entry, (other, value)) in range.clone().zip(self.nodes[range.clone()].iter().zip(&self.values[range])) {
            if let Some(soon) = self.nodes.get(entry + AHEAD) {
                for row in packed[3 * *soon as usize..].iter().take(3) {
                    prefetch(row.as_ptr());
                }
            }
            let first = 3 * *other as usize;
            for (sum, x) in sums.iter_mut().zip(&packed[first..first + 3]) {
                add_multiple(simd, sum, *value, x);
            }
        }
        sums
    }
}

/// Y = A·X, for each run of [`WIDTH`] columns of X.
fn blocked(x: MatRef<'_, f64>, mut y: MatMut<'_, f64>, packed: &mut Vec<Packed>, matrix: &impl NodeRows) {
    let arch = Arch::new();
    packed.resize(x.nrows(), [0.0; WIDTH]);
    for first in (0..x.ncols()).step_by(WIDTH) {
        let width = WIDTH.min(x.ncols() - first);
        let columns = x.subcols(first, width);
        packed.par_chunks_mut(3 * NODES_PER_TASK).enumerate().for_each(|(task, rows)| {
            let columns = columns.subrows(3 * NODES_PER_TASK * task, rows.len());
            for (c, column) in columns.col_iter().enumerate() {
                for (row, value) in rows.iter_mut().zip(column.iter()) {
                    row[c] = *value;
                }
            }
        });
        let y = y.rb_mut().subcols_mut(first, width);
        row_chunks_mut(y, 3 * NODES_PER_TASK).enumerate().for_each(|(task, y)| {
            arch.dispatch(SomeRows { matrix, first: NODES_PER_TASK * task, packed, y });
        });
    }
}

/// Rows of a product from those of a first node on. A type rather than a closure: what a closure calls is compiled without
/// the vector instructions.
struct SomeRows<'a, R> {
    matrix: &'a R,
    first: usize,
    packed: &'a [Packed],
    y: MatMut<'a, f64>,
}

impl<R: NodeRows> WithSimd for SomeRows<'_, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { matrix, first, packed, mut y } = self;
        let mut sums = [[0.0; WIDTH]; 3 * NODES_PER_TASK];
        for node in 0..y.nrows() / 3 {
            sums[3 * node..3 * node + 3].copy_from_slice(&matrix.product(simd, first + node, packed));
        }
        for (c, column) in y.rb_mut().col_iter_mut().enumerate() {
            for (value, sums) in column.iter_mut().zip(&sums) {
                *value = sums[c];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use faer::sparse::{SparseColMat, Triplet};

    /// Independent reference: the products of the dense matrix by faer.
    #[test]
    fn products_equal_the_dense_ones_for_any_number_of_columns() {
        let nodes = 700;
        let entry = |i: usize, j: usize| 1.0 / (1.0 + (i as f64 - j as f64).powi(2)) + ((i * j) as f64).sin();
        let coupled = |i: usize| [i, (i + 1) % nodes, (i + nodes - 1) % nodes, (i + 350) % nodes];
        let scalar: Vec<_> =
            (0..nodes).flat_map(|i| coupled(i).map(|j| Triplet::new(i, j, entry(i.min(j), i.max(j))))).collect();
        let a = SparseColMat::try_new_from_triplets(nodes, nodes, &scalar).unwrap();
        let expanded: Vec<_> =
            scalar.iter().flat_map(|t| (0..3).map(|k| Triplet::new(3 * t.row + k, 3 * t.col + k, t.val))).collect();
        let a3 = SparseColMat::try_new_from_triplets(3 * nodes, 3 * nodes, &expanded).unwrap();
        // The blocks of the same, zeros beside their diagonals.
        let blocks: Vec<f64> = (0..3 * nodes)
            .flat_map(|j| a.row_idx_of_col(j / 3).flat_map(move |i| (0..3).map(move |axis| (3 * i + axis, j))))
            .map(|(i, j)| a3.get(i, j).copied().unwrap_or(0.0))
            .collect();
        for columns in [1, 7, 8, 19] {
            let x = Mat::from_fn(3 * nodes, columns, |i, j| ((i * 7 + j * 13) as f64).cos());
            let expected = a3.to_dense() * &x;
            let general = symmetric_product(a3.as_ref(), x.as_ref());
            let indices: Vec<u32> = a.row_idx().iter().map(|i| *i as u32).collect();
            let mut nodal = Mat::zeros(3 * nodes, columns);
            nodal_product(a.col_ptr(), &indices, a.val(), x.as_ref(), nodal.as_mut(), &mut Vec::new());
            assert!((&general - &expected).norm_max() < 1e-13);
            assert!((&nodal - &expected).norm_max() < 1e-13);
            let blocks = NodeBlocks { start: a.col_ptr(), nodes: &indices, values: &blocks };
            let mut by_blocks = Mat::zeros(3 * nodes, columns);
            blocks_product(blocks, x.as_ref(), by_blocks.as_mut(), &mut Vec::new());
            assert!((&by_blocks - &expected).norm_max() < 1e-13);
        }
    }
}
