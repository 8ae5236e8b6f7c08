//! The linearised equations of a system: small motions about rest or about a steady spin of all bodies together.
//!
//! Eqs. (L1) to (L8) of `docs/method/systems.md`. Changes of place ξ of a body are ρ and φ in body axes, and δq; the bodies turn
//! together, so that in body axes nothing changes with time:
//!
//! ```text
//! δv = ξ̇ + L ξ                            V, ω, q̇ in body axes
//! M ξ̈ + C ξ̇ + K ξ = Gᵀδλ,   G ξ = 0       K with the geometric stiffness of λ
//! ξ = N η,  Nᵀ M N = 1:   η̈ + NᵀC N η̇ + NᵀK N η = 0
//! ```

mod blocks;
pub(crate) mod body;
pub(crate) mod configuration;
mod equilibrium;
pub(crate) mod error;
mod graded;
pub(crate) mod linearization;
mod load;
mod mode;
mod null_space;
mod participation;
mod reaction;
mod refined;
mod rotor;
mod scaled;
mod spin;
pub(crate) mod spin_mode;
mod steady;
mod stiffening;
pub(crate) mod terms;
pub(crate) mod tie;

pub use configuration::CommonSpin;
pub use equilibrium::{Equilibrium, Stability};
pub use error::SteadyError;
pub use linearization::Linearization;
pub use mode::{SystemMode, Vibrations};
pub use participation::SystemParticipation;
pub use reaction::ReactionRows;
pub use rotor::{Rotor, RotorError, TurningJoint};
pub use scaled::ScaledEquations;
pub use spin_mode::SpinMode;
pub use steady::{SteadyState, Unbalance};
pub use stiffening::{BodyStiffening, StiffenedMode};
pub use terms::Spring;
