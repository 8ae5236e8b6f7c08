//! **flexframe**: flexible-body dynamics, from a finite-element mesh to the motion of the body.
//!
//! This crate is the program and a façade: it re-exports the crates it is made of, and [`run`] does what
//! `flexframe run` does.
//!
//! ```no_run
//! use flexframe::model::Model;
//! use flexframe::scene::Body;
//!
//! let body = Body::read("examples/plate.toml")?;
//! let model = Model::build(&body, |_progress| ())?;
//! println!("{:?} Hz", model.natural_frequencies());
//! for now in model.start(&body)? {
//!     let now = now?;
//!     println!("{} {:?} {}", now.time, now.omega_body, now.energy());
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

pub use {
    advice, dynamics, fem_tet10, figures, frames_rk4, linear, modal, model, reduced_body, results, rigid_kin, scene,
};
pub use {faer, nalgebra};

mod commands;
pub mod drawn;
pub mod failure;
mod files;
pub mod forked;
pub mod motion;
pub mod plausible;
pub mod report;
mod rows;
pub mod surface;
pub mod trust;
pub use commands::linear::{fit, frequencies, frf, gradient, linearize, psd, shock, spectra, srs};
pub use commands::pictures::{animation, html_report, mode_shapes};
pub use commands::{
    accuracy, advise, campbell, check, cost, equilibrium, export, fmu, hand_over, modes, new_scene, paper, run, sweep,
    system_modes, verify,
};
pub use files::{given_file, outputs, write_error};
pub use rows::{columns, peak_stress, row};
