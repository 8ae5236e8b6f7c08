//! Products of a sparse symmetric matrix with a block of vectors.
//!
//! The block is repacked so that the numbers of a row lie side by side: the matrix is then read once for
//! [`WIDTH`] vectors and each of its entries meets one contiguous run.

use faer::reborrow::ReborrowMut;
use faer::sparse::SparseColMatRef;
use faer::{Mat, MatMut, MatRef};
use rayon::prelude::*;

/// Vectors handled in one pass over the matrix.
pub(crate) const WIDTH: usize = 8;
/// Nodes that one task computes.
const NODES_PER_TASK: usize = 128;

/// One row of a packed block.
pub(crate) type Packed = [f64; WIDTH];

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
    let (col_ptr, row_idx, values) = (a.symbolic().col_ptr(), a.symbolic().row_idx(), a.val());
    blocked(x, y, packed, |node, packed| {
        std::array::from_fn(|axis| {
            // A column of a symmetric matrix is its row.
            let column = 3 * node + axis;
            let mut sum = [0.0; WIDTH];
            for entry in col_ptr[column]..col_ptr[column + 1] {
                add_scaled(&mut sum, values[entry], &packed[row_idx[entry]]);
            }
            sum
        })
    });
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
    blocked(x, y, packed, |node, packed| {
        let mut sums = [[0.0; WIDTH]; 3];
        for entry in start[node]..start[node + 1] {
            let rows = &packed[3 * nodes[entry] as usize..];
            for (sum, x) in sums.iter_mut().zip(rows) {
                add_scaled(sum, values[entry], x);
            }
        }
        sums
    });
}

fn add_scaled(sum: &mut Packed, value: f64, x: &Packed) {
    for (s, x) in sum.iter_mut().zip(x) {
        *s += value * x;
    }
}

/// Applies `node_sums`, which gives the three rows of a node in the product, to each run of [`WIDTH`] columns of `x`.
fn blocked(
    x: MatRef<'_, f64>,
    mut y: MatMut<'_, f64>,
    packed: &mut Vec<Packed>,
    node_sums: impl Fn(usize, &[Packed]) -> [Packed; 3] + Sync,
) {
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
        y.rb_mut().subcols_mut(first, width).par_row_chunks_mut(3 * NODES_PER_TASK).enumerate().for_each(
            |(task, mut rows)| {
                let mut sums = [[0.0; WIDTH]; 3 * NODES_PER_TASK];
                for (i, sums) in sums[..rows.nrows()].chunks_exact_mut(3).enumerate() {
                    sums.copy_from_slice(&node_sums(NODES_PER_TASK * task + i, packed));
                }
                for (c, column) in rows.rb_mut().col_iter_mut().enumerate() {
                    for (value, sums) in column.iter_mut().zip(&sums) {
                        *value = sums[c];
                    }
                }
            },
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use faer::sparse::{SparseColMat, Triplet};

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
        for columns in [1, 7, 8, 19] {
            let x = Mat::from_fn(3 * nodes, columns, |i, j| ((i * 7 + j * 13) as f64).cos());
            let expected = a3.to_dense() * &x;
            let general = symmetric_product(a3.as_ref(), x.as_ref());
            let indices: Vec<u32> = a.row_idx().iter().map(|i| *i as u32).collect();
            let mut nodal = Mat::zeros(3 * nodes, columns);
            nodal_product(a.col_ptr(), &indices, a.val(), x.as_ref(), nodal.as_mut(), &mut Vec::new());
            assert!((&general - &expected).norm_max() < 1e-13);
            assert!((&nodal - &expected).norm_max() < 1e-13);
        }
    }
}
