//! Linear models of small motions, of plain numbers and names: no mesh, no body.
//!
//! ```text
//! η̈ + C η̇ + K η = B u                       coordinates η, inputs u       (F1)
//! y = R₀ η + R₁ η̇ + R₂ η̈ + D₀ u              outputs                       (F2)
//! x' = A x + B u,   y = C x + D u,  x = (η, η̇)                            (F3)
//! H(ω) = (R₀ + i ω R₁ − ω² R₂) (K − ω² + i ω C)⁻¹ B + D₀                  (F4)
//! ```
//!
//! Equations have the numbers of `docs/method/linear.md`.

#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

mod channel;
mod error;
mod frequency_response;
mod mat_file;
mod modal_form;
mod quadrature;
mod random;
mod real_modes;
mod rows;
mod second_order;
mod state_space;
mod truncation;
mod values;

pub use channel::Channel;
pub use error::LinearError;
pub use faer;
pub use frequency_response::FrequencyResponse;
pub use mat_file::{MatArray, mat_file};
pub use quadrature::Quadrature;
pub use random::{RandomInput, RandomResponse};
pub use real_modes::RealModes;
pub use second_order::{Damping, Output, Rate, SecondOrder};
pub use state_space::StateSpace;
pub use truncation::balanced::Balanced;
