//! A run that a page in a browser leads on.
//!
//! [`LiveRun`] is the run as data: what each motion begins with. [`Player`] makes the motions of it and leads them to a time. As
//! long as nothing is changed they are those of the recorded run, step by step. A change (a load's size, a spring, a damping, a
//! spin, a pull at a point) makes the motion anew from its data and goes on from the state that was reached.
//!
//! Built for `wasm32-unknown-unknown` it is the program of the page: see `exports.rs` for its functions.
#![deny(unsafe_code)] // only `exports` allows it
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

mod change;
mod error;
#[cfg(target_family = "wasm")]
mod exports;
mod motion;
mod player;
mod pull;
mod run;

pub use change::Change;
pub use error::LiveError;
pub use player::{BODY_NUMBERS, Player};
pub use run::{LiveMotion, LiveRun};

/// Crates whose types are in the interface.
pub use dynamics;
