#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

pub mod accuracy;
pub mod check;
mod lot;
pub mod nonlinear;
pub mod stability;
pub mod systems;
pub mod trials;
