//! Mass, stiffness and forces.

pub(crate) mod expansion;
pub(crate) mod finite_strain;
pub(crate) mod geometric_stiffness;
pub(crate) mod mass;
pub(crate) mod mean_rotation;
pub(crate) mod point_masses;
pub(crate) mod rates;
pub(crate) mod second_order;
pub(crate) mod stiffness;
pub(crate) mod stress;
pub(crate) mod surface;
