//! Rows and results files under the names of their columns.

pub(crate) mod check;
pub(crate) mod columns;
pub(crate) mod results;
pub(crate) mod row;
pub(crate) mod run;
