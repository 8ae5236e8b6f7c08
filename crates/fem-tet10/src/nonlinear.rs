//! Terms beyond linear strain.

pub(crate) mod finite_strain;
pub(crate) mod geometric_stiffness;
pub(crate) mod second_order;
