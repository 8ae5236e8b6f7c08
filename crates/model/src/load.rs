//! Loads on the mesh, and their histories.

pub(crate) mod directed;
pub(crate) mod history;
pub(crate) mod mesh_load;
pub(crate) mod rotation;
pub(crate) mod turning;
