//! Terms beyond linear strain.

pub(crate) mod element_sums;
pub(crate) mod expansion;
pub(crate) mod finite_strain;
pub(crate) mod geometric_stiffness;
pub(crate) mod second_order;
