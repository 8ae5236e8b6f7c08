//! Linear strain, and stiffening by stress.

pub(crate) mod backbone;
pub(crate) mod error;
pub(crate) mod error_bound;
pub(crate) mod stress;
