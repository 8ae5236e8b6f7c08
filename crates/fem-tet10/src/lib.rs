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
//! * Physical groups of surfaces carry loads, see [`Mesh::surface_weights`] and [`Mesh::surface_pressure`]; groups of any
//!   dimension, boxes, balls and lines pick nodes, see [`Mesh::group_nodes`]; [`Mesh::mean_rotation`] carries a moment.
//! * [`assemble`] fills K and M in parallel over the pairs of coupled nodes. Nothing of size N×N is ever dense.
//! * [`reduced_geometric_stiffness`] gives the stress stiffness of displacement fields, reduced to a few shapes;
//!   [`second_order_forces`] and [`second_order_energies`] what displacements of second order meet in a St. Venant–Kirchhoff
//!   body; [`FiniteStrain`] its stresses, internal forces and stiffness at any displacement.
//! * [`StressRecovery`] gives the stress of displacement fields at the nodes, and an estimate of its error; [`von_mises`] and
//!   [`principal_stresses`] what a stress is in any axes.
//!
//! Degrees of freedom are numbered `3·node + axis`. Any consistent set of units will do; the mesh's frame
//! is the frame of every vector here.
#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

mod assembly;
mod element;
mod error;
mod material;
mod mesh;
mod nonlinear;
mod stress;

pub use assembly::lumped::{LumpedInertia, centroid_lumped_inertia};
pub use assembly::matrices::{Matrices, assemble};
pub use assembly::mean_rotation::MeanRotation;
pub use assembly::patch::Patch;
pub use assembly::point_mass::PointMass;
pub use assembly::rates::{BodyNumber, MatrixRates, stretch};
pub use assembly::strips::Strip;
pub use element::quadrature;
pub use element::shape::{shape_functions, shape_gradients};
pub use error::{AssemblyError, AssemblyFault, FilePosition, MeshError, MeshFault};
/// The crate whose types are in the interface.
pub use faer;
pub use material::{Material, Materials};
pub use mesh::checked::Mesh;
pub use mesh::locate::Location;
pub use mesh::msh::{msh_bytes, parse_msh, read_msh};
pub use mesh::parts::{MeshParts, NodeGroup, SurfaceGroup};
pub use nonlinear::expansion::Expansion;
pub use nonlinear::finite_strain::{FiniteStrain, Stresses};
pub use nonlinear::geometric_stiffness::{extended_geometric_stiffness, reduced_geometric_stiffness};
pub use nonlinear::second_order::{second_order_energies, second_order_forces};
pub use stress::{COMPONENTS, StressError, StressRecovery, StressSites, principal_stresses, von_mises};
