//! Rows of a results file, and the quantities in them.

pub mod columns;
pub(crate) mod effects;
pub mod peak_stress;
pub mod row;
pub(crate) mod units;
