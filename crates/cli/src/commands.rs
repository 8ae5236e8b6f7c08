//! The commands of the program, each with its options.

pub mod advise;
pub mod campbell;
pub mod check;
pub mod cost;
pub mod equilibrium;
pub mod fmu;
pub mod linear;
pub mod modes;
pub mod new;
pub mod paper;
pub mod pictures;
pub mod reduce;
pub mod resume;
pub mod run;
pub mod sweep;
pub mod verify;
