//! The order in which the entries of a symmetric 3×3 matrix are listed.

/// ij = 11, 22, 33, 23, 13, 12, counted from zero.
pub(crate) const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)];
