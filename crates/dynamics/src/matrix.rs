//! Layouts of small matrices and lists for the time loop.

#[cfg(test)]
mod against_faer;
pub(crate) mod blocked_matrix;
pub(crate) mod four;
pub(crate) mod lists;
pub(crate) mod side_by_side;
pub(crate) mod stack;
pub(crate) mod symmetric;
pub(crate) mod triangle;
