//! The table of effects.

pub(crate) mod completed;
pub(crate) mod estimate;
pub(crate) mod number;
pub(crate) mod relative;
pub(crate) mod row;
pub(crate) mod rows;
