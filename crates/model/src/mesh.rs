//! The mesh or the matrices of a body.

pub(crate) mod arrays;
pub(crate) mod doubt;
pub(crate) mod fe_matrices;
pub(crate) mod given;
pub(crate) mod others;
pub(crate) mod read;
