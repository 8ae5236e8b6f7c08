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
//! large rotation of a body uses of any other mass, [`Modes::reduced`] says.
//!
//! [`ReducedBody`](reduced_body::ReducedBody) holds the constants that the motion of the body needs, with nothing of the mesh's size.

#![deny(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

mod eigen;
mod error;
mod factor;
mod input;
mod matrix;
mod memory_estimate;
mod multigrid;
mod progress;
mod rates;
mod reduction;
mod solve;
mod statics;
mod support;

pub use eigen::engine::{Eigenpairs, Engine, EngineStats, StaticAnswers};
pub use error::{EngineError, ModalError};
pub use factor::indefinite::{IndefiniteFactor, IndefiniteOrder};
pub use matrix::mass::NodalMass;
pub use matrix::mass_matrix::{GeneralMass, MassMatrix};
pub use matrix::stiffness::{NodalStiffness, StiffnessMatrix};
pub use matrix::tall::side_by_side;
pub use matrix::tied_mass::{TiedPoint, mass_with_points};
pub use memory_estimate::{Forecast, reserve_of_dense_products};
pub use multigrid::NoCycles;
pub use progress::{EnginePhase, Progress};
pub use rates::{ModeRates, repeated};
pub use reduction::fields::{acceleration_fields, centrifugal_accelerations, centrifugal_fields, turning_field};
pub use solve::{Modes, SolveStats, Solver};
pub use statics::answered::StaticAnswer;
pub use statics::large_shapes::LargeShapes;
pub use statics::mass_left_out::mass_left_out;
pub use statics::response::StaticAccuracy;

pub use support::constraints::Constraints;
pub use support::held::Support;
pub use support::held_problem::{HeldMatrix, HeldProblem};

pub use support::rigid::RigidModes;
/// Crates whose types are in the interface.
pub use {faer, nalgebra};
