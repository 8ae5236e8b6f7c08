//! Mass, stiffness and forces on the nodes of a mesh.

pub(crate) mod coupling;
pub(crate) mod lumped;
pub(crate) mod matrices;
pub(crate) mod mean_rotation;
pub(crate) mod patch;
pub(crate) mod point_mass;
pub(crate) mod rates;
pub(crate) mod strips;
pub(crate) mod surface;
