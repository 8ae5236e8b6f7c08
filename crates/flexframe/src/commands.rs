//! Commands, as functions.

pub mod advise;
pub mod animation;
pub mod campbell;
pub mod check;
pub mod cost;
pub mod export;
pub mod fmu;
pub mod frf;
pub mod hand_over;
pub mod html_report;
pub mod linearize;
pub mod mode_shapes;
pub mod modes;
pub mod new_scene;
pub mod paper;
pub mod run;
pub mod srs;
pub mod sweep;
pub mod system_modes;
