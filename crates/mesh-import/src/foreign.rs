//! Files that gmsh and meshio read: what they are given, and what they say.

pub(crate) mod geometry;
mod gmsh_errors;
pub(crate) mod run;
