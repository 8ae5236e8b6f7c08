//! The library inside the FMUs that `flexframe fmu` packs: FMI 2.0 for co-simulation.
//!
//! `motion` is the body between two communication points, `instance` the states that the standard has for an FMU, and
//! `c_interface` the functions of the standard. Only the last has unsafe code. Nothing is shared between instances.
//!
//! Inputs are held from one communication point to the next. Each communication step is a run of its own for the scheme: it
//! starts from the inputs as they are, and ends on the next communication point, in the scene's step or in equal steps that
//! are a little shorter. So forces that jump at communication points cost no order.
#![deny(unsafe_code)] // only `c_interface` allows it
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

pub mod c_interface;
mod error;
mod instance;
mod location;
mod motion;
mod phase;
