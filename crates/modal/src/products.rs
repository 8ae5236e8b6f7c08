//! Products of a sparse symmetric matrix with a block of vectors.
//!
//! The block is repacked so that the numbers of a row lie side by side: the matrix is then read once for
//! [`WIDTH`] vectors and each of its entries meets one contiguous run.

use faer::sparse::SparseColMatRef;
use faer::{Mat, MatMut, MatRef};
use rayon::prelude::*;

/// Vectors handled in one pass over the matrix.
const WIDTH: usize = 8;
/// Rows that one task computes.
const ROWS_PER_TASK: usize = 512;

/// A·X for a symmetric A with both triangles stored.
pub(crate) fn symmetric_product(a: SparseColMatRef<'_, usize, f64>, x: MatRef<'_, f64>) -> Mat<f64> {
    let (col_ptr, row_idx, values) = (a.symbolic().col_ptr(), a.symbolic().row_idx(), a.val());
    blocked(x, 1, |row, packed| {
        // Column `row` of a symmetric matrix is its row.
        let mut sum = [0.0; WIDTH];
        for entry in col_ptr[row]..col_ptr[row + 1] {
            let value = values[entry];
            for (s, x) in sum.iter_mut().zip(&packed[row_idx[entry]]) {
                *s += value * x;
            }
        }
        [sum; 1]
    })
}

/// (A ⊗ I₃)·X for a symmetric matrix A over nodes, in compressed rows.
pub(crate) fn nodal_product(start: &[usize], nodes: &[u32], values: &[f64], x: MatRef<'_, f64>) -> Mat<f64> {
    blocked(x, 3, |node, packed| {
        let mut sum = [[0.0; WIDTH]; 3];
        for entry in start[node]..start[node + 1] {
            let value = values[entry];
            let rows = &packed[3 * nodes[entry] as usize..];
            for (s, x) in sum.iter_mut().zip(rows) {
                for (s, x) in s.iter_mut().zip(x) {
                    *s += value * x;
                }
            }
        }
        sum
    })
}

/// Applies `row_sums`, which gives `D` rows of the product at a time, to each run of [`WIDTH`] columns of `x`.
fn blocked<const D: usize>(
    x: MatRef<'_, f64>,
    rows_at_once: usize,
    row_sums: impl Fn(usize, &[[f64; WIDTH]]) -> [[f64; WIDTH]; D] + Sync,
) -> Mat<f64> {
    debug_assert_eq!(rows_at_once, D);
    let mut y = Mat::zeros(x.nrows(), x.ncols());
    let mut packed = vec![[0.0; WIDTH]; x.nrows()];
    let mut product = vec![[0.0; WIDTH]; x.nrows()];
    for first in (0..x.ncols()).step_by(WIDTH) {
        let width = WIDTH.min(x.ncols() - first);
        let columns = x.subcols(first, width);
        pack(columns, &mut packed);
        product.par_chunks_mut(D * ROWS_PER_TASK).enumerate().for_each(|(task, rows)| {
            for (i, rows) in rows.chunks_exact_mut(D).enumerate() {
                rows.copy_from_slice(&row_sums(task * ROWS_PER_TASK + i, &packed));
            }
        });
        unpack(&product, y.as_mut().subcols_mut(first, width));
    }
    y
}

fn pack(columns: MatRef<'_, f64>, packed: &mut [[f64; WIDTH]]) {
    for c in 0..WIDTH {
        if c < columns.ncols() {
            for (packed, x) in packed.iter_mut().zip(columns.col(c).iter()) {
                packed[c] = *x;
            }
        } else {
            packed.iter_mut().for_each(|packed| packed[c] = 0.0);
        }
    }
}

fn unpack(product: &[[f64; WIDTH]], mut columns: MatMut<'_, f64>) {
    for c in 0..columns.ncols() {
        for (product, y) in product.iter().zip(columns.rb_mut().col_mut(c).iter_mut()) {
            *y = product[c];
        }
    }
}

use faer::reborrow::ReborrowMut;

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
            let nodal = nodal_product(a.col_ptr(), &indices, a.val(), x.as_ref());
            assert!((&general - &expected).norm_max() < 1e-13);
            assert!((&nodal - &expected).norm_max() < 1e-13);
        }
    }
}
