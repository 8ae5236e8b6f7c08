//! The Cholesky factor of K + sM, and factors of matrices that need not be definite.

#[cfg(all(test, feature = "threads-in-faer"))]
mod against_faer;
pub(crate) mod cholesky;
pub(crate) mod dissection;
pub(crate) mod indefinite;
pub(crate) mod interleave;
pub(crate) mod layout;
pub(crate) mod ordering;
pub(crate) mod shifted;
pub(crate) mod shifted_matrix;
pub(crate) mod substitution;
pub(crate) mod subtrees;
pub(crate) mod supernode;
pub(crate) mod supernodes;
pub(crate) mod symbolic;
