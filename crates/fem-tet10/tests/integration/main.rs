//! The public interface, on meshes that gmsh wrote. One program, so that it is linked once.

mod ball;
mod fixtures;
mod matrices;
mod meshes;
