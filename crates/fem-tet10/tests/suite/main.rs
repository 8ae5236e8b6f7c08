//! The public interface, on meshes that gmsh wrote. One program, so that it is linked once.

mod ball;
mod curved;
mod edge_ends;
mod fixtures;
mod geometric_stiffness;
mod locate;
mod mass;
mod mean_rotation;
mod point_masses;
mod reader;
mod refused_files;
mod refused_meshes;
mod refused_models;
mod second_order;
mod selection;
mod stiffness;
mod stress;
mod surface;
