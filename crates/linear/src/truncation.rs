//! Models of lower order.

pub(crate) mod balanced;
mod modal;
mod parts;
