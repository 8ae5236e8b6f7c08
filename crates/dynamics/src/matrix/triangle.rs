//! The lower triangle of a symmetric matrix, row by row.

/// Place of the entry i ≥ j.
pub(crate) fn entry(i: usize, j: usize) -> usize {
    i * (i + 1) / 2 + j
}
