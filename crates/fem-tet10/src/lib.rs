//! Second-order tetrahedra (tet10): gmsh meshes in, consistent mass and stiffness matrices out.
//!
//! ```text
//! K = ∫ Bᵀ D B dV        M = ∫ ρ Nᵀ N dV + Σ m_p w_p w_pᵀ ⊗ I₃
//! ```
//!
//! * [`read_msh`] reads MSH 4.1 (ASCII and binary) into a [`Mesh`], which is checked when it is made:
//!   every node belongs to an element, no element is inverted, the body is in one piece.
//! * [`Material`]s are given to physical groups by name, see [`Materials`].
//! * [`PointMass`]es sit anywhere on the body; [`Mesh::locate`] turns a point into nodes and weights.
//! * [`assemble`] fills K and M in parallel into one sparsity pattern. Nothing of size N×N is ever dense.
//! * [`reduced_geometric_stiffness`] gives the stress stiffness of displacement fields, reduced to a few shapes.
//!
//! Degrees of freedom are numbered `3·node + axis`. Any consistent set of units will do; the mesh's frame
//! is the frame of every vector here.
#![forbid(unsafe_code)]

mod assembly;
mod error;
mod geometric_stiffness;
mod integration;
mod locate;
mod lumped;
mod material;
mod mesh;
mod msh;
mod point_mass;
mod quadrature;
mod shape;

pub use assembly::{Matrices, assemble};
pub use error::{AssemblyError, MeshError, Place};
pub use geometric_stiffness::reduced_geometric_stiffness;
pub use locate::Location;
pub use lumped::{LumpedInertia, centroid_lumped_inertia};
pub use material::{Material, Materials};
pub use mesh::{Mesh, MeshParts};
pub use msh::{parse_msh, read_msh};
pub use point_mass::PointMass;
pub use shape::{shape_functions, shape_gradients};
