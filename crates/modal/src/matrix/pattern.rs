//! Where the entries of a sparse matrix are.

use faer::sparse::{SymbolicSparseColMat, SymbolicSparseColMatRef};

/// Where the entries of a matrix are.
pub(crate) enum Pattern<'a> {
    /// As they are kept.
    Given(SymbolicSparseColMatRef<'a, usize>),
    /// Made for the purpose.
    Made(SymbolicSparseColMat<usize>),
}

impl Pattern<'_> {
    pub(crate) fn as_ref(&self) -> SymbolicSparseColMatRef<'_, usize> {
        match self {
            Self::Given(pattern) => *pattern,
            Self::Made(pattern) => pattern.as_ref(),
        }
    }
}
