//! Files, meshes and places on them.

pub(crate) mod curved;
pub(crate) mod edge_ends;
pub(crate) mod locate;
pub(crate) mod reader;
pub(crate) mod refused_files;
pub(crate) mod refused_meshes;
pub(crate) mod refused_models;
pub(crate) mod selection;
