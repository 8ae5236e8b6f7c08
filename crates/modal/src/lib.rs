//! Vibration modes of a free body from its sparse matrices, and the reduced body made from them.
//!
//! ```text
//! K φ = λ M φ,   ω = √λ,   φᵀ M φ = 1
//! ```
//!
//! [`solve()`] takes any symmetric sparse K and M with three degrees of freedom a node (`3·node + axis`) and the
//! positions of the nodes. K of a free body is singular: its six rigid modes are known from the geometry
//! ([`RigidModes`]), checked against K, and kept out of the search, which works on `K + sM`, s > 0.
//! Modes come out mass-normalised, the component of largest magnitude positive.
//!
//! [`ReducedBody`] holds the constants that the motion of the body needs, with nothing of the mesh's size.

mod dense;
mod error;
mod lanczos;
mod mass;
mod ordering;
mod products;
mod reduced;
mod rigid;
mod shifted;
mod solve;
mod start;
mod support;
mod symmetry;
mod tall;

pub use error::ModalError;
pub use mass::NodalMass;
pub use reduced::{BodyPoint, ReducedBody};
pub use rigid::RigidModes;
pub use solve::{Modes, Progress, SolveStats, solve};
pub use support::{RigidMotion, Support};
