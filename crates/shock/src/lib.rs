//! Shock response spectra of a base motion, and sums of the peaks of modes.
//!
//! ```text
//! z'' + 2 ζ ω z' + ω² z = −a(t)            z = z' = 0 at the first time         (R1)
//! w = a + z'' = −(2 ζ ω z' + ω² z)          acceleration of the mass             (R2)
//! ```
//!
//! a is the acceleration of the base, z the displacement of an oscillator relative to it. A spectrum has the largest |z| and the
//! extremes of w against ω. Equations have the numbers of `docs/method/shock.md`.
//!
//! The crate knows numbers only: no mesh, no mode.

#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

mod base_motion;
mod error;
mod extremes;
mod oscillator;
mod spectrum;
mod sum;

pub use base_motion::BaseMotion;
pub use error::ShockError;
pub use spectrum::{Following, Peaks, Spectrum};
pub use sum::{ModalPeak, Sum, correlation};
