//! Commands, as functions.

pub mod accuracy;
pub mod advise;
pub mod campbell;
pub mod check;
pub mod cost;
pub mod equilibrium;
pub mod export;
pub mod fmu;
pub mod hand_over;
pub mod linear;
pub mod modes;
pub mod new_scene;
pub mod paper;
pub mod pictures;
pub mod run;
pub mod sweep;
pub mod system_modes;
pub mod verify;
