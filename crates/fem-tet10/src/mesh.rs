//! Meshes of ten-node tetrahedra, their files and places on them.

pub(crate) mod checked;
pub(crate) mod faces;
pub(crate) mod locate;
pub(crate) mod msh;
pub(crate) mod parts;
pub(crate) mod selection;
pub(crate) mod tags;
