//! The full nonlinear body of a mesh, beside its reduced models: its equilibria, and the true error of a state.
//!
//! ```text
//! M a = f(u) − f_int(u)        K* = ∫ B(u)ᵀ C B(u) + G(S) − M W        e = K*⁻¹ (f(u) − f_int(u) − M a)
//! ```
//!
//! * [`FullBody`] is a St. Venant–Kirchhoff body of ten-node tetrahedra with its support.
//! * [`ExternalForces`] act on its displaced nodes: dead forces, pressures that follow their surface, moments and forces that turn
//!   with the material.
//! * [`Tangent`] is K* factored, with a stress S that stands beside the displacements: it solves, and counts its negative
//!   eigenvalues.
//! * [`equilibrium()`] finds the rest under steady forces and a steady spin by Newton's iteration with the stress as an unknown of
//!   its own (Magisano, Leonetti and Garcea 2017).
//! * [`state_error()`] tells how far a displacement is from that of the full body, and [`true_frequencies`] the frequencies about
//!   it.
//!
//! Displacements and forces are lists of 3n numbers, row `3·node + axis`, in the axes of the body's frame. Equations and their
//! limits are in `docs/method/check.md`.
#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

mod body;
mod equilibrium;
mod error;
mod followers;
mod forces;
mod frequencies;
mod spinning;
mod state_error;
mod tangent;
mod vectors;

pub use body::FullBody;
pub use equilibrium::{Equilibrium, EquilibriumSettings, equilibrium};
pub use error::NonlinearError;
pub use forces::{Acting, ExternalForces};
pub use frequencies::{Vibration, true_frequencies};
pub use spinning::{SpinVibration, spin_vibrations};
pub use state_error::{FullState, StateError, StateErrorSettings, state_error};
pub use tangent::{Tangent, TangentTerms};
