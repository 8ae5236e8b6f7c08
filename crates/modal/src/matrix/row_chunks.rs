//! Rows of a matrix, cut at fixed places, for tasks that are done side by side.
//!
//! faer is built without threads: what its products, factors and eigenvalues come to depends, in their last bits, on how many
//! threads share them. All that is done side by side is cut here, or by rayon's own chunks, at places that the sizes alone say.

use faer::{MatMut, MatRef};
use rayon::prelude::*;

/// An equal number of rows each, the last ones fewer.
pub(crate) fn row_chunks(a: MatRef<'_, f64>, rows: usize) -> impl IndexedParallelIterator<Item = MatRef<'_, f64>> {
    let chunk = move |task: usize| a.subrows(rows * task, rows.min(a.nrows() - rows * task));
    (0..a.nrows().div_ceil(rows)).into_par_iter().map(chunk)
}

/// The same, to be changed.
pub(crate) fn row_chunks_mut(a: MatMut<'_, f64>, rows: usize) -> impl IndexedParallelIterator<Item = MatMut<'_, f64>> {
    let mut chunks = Vec::with_capacity(a.nrows().div_ceil(rows));
    let mut rest = a;
    while rest.nrows() > rows {
        let (first, others) = rest.split_at_row_mut(rows);
        chunks.push(first);
        rest = others;
    }
    if rest.nrows() > 0 {
        chunks.push(rest);
    }
    chunks.into_par_iter()
}

#[cfg(test)]
mod tests {
    use faer::{Mat, Par};

    use super::*;

    #[test]
    fn all_rows_are_there_once_and_in_their_order() {
        for rows in [0, 1, 4, 7, 8] {
            let mut a = Mat::from_fn(rows, 2, |i, j| (2 * i + j) as f64);
            let heights: Vec<usize> = row_chunks(a.as_ref(), 4).map(|chunk| chunk.nrows()).collect();
            assert_eq!(heights, (0..rows).step_by(4).map(|first| 4.min(rows - first)).collect::<Vec<_>>());
            row_chunks_mut(a.as_mut(), 4).enumerate().for_each(|(task, mut chunk)| {
                assert_eq!(chunk.nrows(), heights[task]);
                (0..chunk.nrows()).for_each(|i| chunk[(i, 1)] -= (8 * task + 2 * i) as f64);
            });
            assert!(a.col_iter().nth(1).is_none_or(|column| column.iter().all(|value| *value == 1.0)));
        }
    }

    /// With the feature `rayon` of faer it would be all threads of the machine.
    #[test]
    fn faer_uses_no_threads() {
        assert_eq!(faer::get_global_parallelism(), Par::Seq);
    }
}
