//! Vibration modes and static responses of a body, free or held, from its sparse matrices, and the reduced body made
//! from them.
//!
//! ```text
//! K φ = λ M φ,   ω = √λ,   φᵀ M φ = 1
//! ```
//!
//! [`Solver`] takes any symmetric sparse K and M of the body without supports, with three or six degrees of freedom a node
//! (translations, then small rotations), the positions of the nodes, and the [`Support`]. K has no stiffness against the rigid modes that
//! the support leaves; they are known from the geometry ([`RigidModes`]), checked against K, and kept out of the search,
//! which works on `K + sM`, s > 0, in the space of the displacements that the support allows.
//! Modes come out mass-normalised, the component of largest magnitude positive.
//!
//! A mass that is a scalar for each pair of nodes ([`NodalMass`]: solid elements, point masses) is kept as that. What the
//! large rotation of a body uses of any other mass, [`ReducedBody::new`] says.
//!
//! [`ReducedBody`] holds the constants that the motion of the body needs, with nothing of the mesh's size.

#![deny(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

mod buckling;
mod cholesky;
mod coarse;
mod columns;
mod constraints;
mod davidson;
mod dense;
mod engine;
mod error;
mod factor_layout;
mod fields;
mod held_dofs;
mod held_problem;
mod inertia_products;
mod inertia_relief;
mod input;
mod interleave;
mod lanczos;
mod levels;
mod make_levels;
mod mass;
mod mass_left_out;
mod mass_matrix;
mod memory_estimate;
mod modes_by_cycles;
mod multigrid;
#[cfg(test)]
mod multigrid_tests;
mod node_pairs;
mod ordering;
mod outside;
mod packed_rows;
mod pairs;
mod pattern;
mod polynomials;
mod products;
mod progress;
mod reduced;
mod reduced_general;
mod reduced_nodal;
mod reduction_parts;
mod renumbering;
mod rigid;
mod rigid_body;
mod rigid_fields;
mod ritz;
mod row_chunks;
mod second_order;
mod shifted;
mod shifted_matrix;
mod smoother;
mod solve;
mod spatial_order;
mod start;
mod statics;
mod stiffness;
mod substitution;
mod subtrees;
mod supernode;
mod supernodes;
mod support;
mod svqb;
mod symbolic;
mod symmetry;
mod tall;
mod turned;

pub use buckling::BucklingAccuracy;
pub use engine::{Eigenpairs, Engine, EngineStats, StaticAnswers};
pub use error::{EngineError, ModalError};
pub use fields::{acceleration_fields, centrifugal_fields, turning_field};
pub use held_problem::{HeldMatrix, HeldProblem};
pub use mass::NodalMass;
pub use mass_left_out::mass_left_out;
pub use mass_matrix::{GeneralMass, MassMatrix};
pub use memory_estimate::{Forecast, reserve_of_dense_products};
pub use progress::{EnginePhase, Progress};
pub use reduced::{BodyPoint, Constants, ReducedBody};
pub use rigid::RigidModes;
pub use second_order::SecondOrderShapes;
pub use solve::{Modes, SolveStats, Solver};
pub use statics::StaticAccuracy;
pub use stiffness::{NodalStiffness, StiffnessMatrix};
pub use support::{RigidMotion, Support, Twist};
/// Crates whose types are in the interface.
pub use {faer, nalgebra};
