//! **flexframe**: flexible-body dynamics, from a finite-element mesh to the motion of the body.
//!
//! This crate is the program and a façade: it re-exports the crates it is made of, and [`run`] does what
//! `flexframe run` does.
//!
//! ```no_run
//! use flexframe::scene::{Model, Scene};
//!
//! let scene = Scene::read("examples/plate.toml")?;
//! let model = Model::build(&scene, |_progress| ())?;
//! println!("{:?} Hz", model.natural_frequencies());
//! for now in model.start(&scene)? {
//!     let now = now?;
//!     println!("{} {:?} {}", now.time, now.omega_body, now.energy());
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

pub use {advice, dynamics, fem_tet10, figures, frames_rk4, modal, results, rigid_kin, scene};
pub use {faer, nalgebra};

pub mod advise;
pub mod animation;
pub mod campbell;
pub mod columns;
pub mod cost;
pub mod drawn;
mod effects;
pub mod export;
pub mod failure;
pub mod fmu;
pub mod forked;
pub mod given_file;
pub mod html_report;
mod json;
pub mod mode_shapes;
pub mod modes;
pub mod new_scene;
pub mod outputs;
pub mod paper;
pub mod peak_stress;
pub mod plausible;
pub mod report;
mod results_path;
pub mod row;
pub mod run;
mod scene_file;
pub mod surface;
pub mod sweep;
mod units;
pub mod write_error;
