//! Static responses and stress.

pub(crate) mod engine;
pub(crate) mod fields;
pub(crate) mod responses;
pub(crate) mod static_shapes;
pub(crate) mod stress;
