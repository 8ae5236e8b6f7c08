//! Vibration modes and static answers of a body, free or held, from its sparse matrices, and the reduced body made
//! from them.
//!
//! ```text
//! K φ = λ M φ,   ω = √λ,   φᵀ M φ = 1
//! ```
//!
//! [`Solver`] takes any symmetric sparse K and M of the body without supports, with three degrees of freedom a node
//! (`3·node + axis`), the positions of the nodes, and the [`Support`]. K has no stiffness against the rigid modes that
//! the support leaves; they are known from the geometry ([`RigidModes`]), checked against K, and kept out of the search,
//! which works on `K + sM`, s > 0, in the space of the displacements that the support allows.
//! Modes come out mass-normalised, the component of largest magnitude positive.
//!
//! [`ReducedBody`] holds the constants that the motion of the body needs, with nothing of the mesh's size.

#![deny(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

mod buckling;
mod constraints;
mod dense;
mod error;
mod fields;
mod foretold;
mod lanczos;
mod mass;
mod ordering;
mod pairs;
mod products;
mod reduced;
mod rigid;
mod rigid_body;
mod ritz;
mod second_order;
mod shifted;
mod solve;
mod start;
mod statics;
mod support;
mod symmetry;
mod tall;

pub use error::ModalError;
pub use fields::{acceleration_fields, centrifugal_fields, turning_field};
pub use mass::NodalMass;
pub use reduced::{BodyPoint, Constants, ReducedBody};
pub use rigid::RigidModes;
pub use second_order::SecondOrderShapes;
pub use solve::{Modes, Progress, SolveStats, Solver};
pub use support::{RigidMotion, Support};
/// Crates whose types are in the interface.
pub use {faer, nalgebra};
