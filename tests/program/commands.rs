//! Commands, with their outputs.

pub(crate) mod accuracy;
pub(crate) mod advise;
pub(crate) mod body;
pub(crate) mod carried;
pub(crate) mod check;
pub(crate) mod cost;
pub(crate) mod equilibrium;
pub(crate) mod export;
pub(crate) mod fmu;
pub(crate) mod html_report;
pub(crate) mod new_scene;
pub(crate) mod sweep;
pub(crate) mod systems;
pub(crate) mod trust;
pub(crate) mod verify;
