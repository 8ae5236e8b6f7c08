//! A motion step by step, and what Python functions do to it.

pub(crate) mod faults;
pub(crate) mod joint_equation;
pub(crate) mod joint_force;
pub(crate) mod law;
pub(crate) mod load;
pub(crate) mod marker_force;
pub(crate) mod seen;
pub(crate) mod simulation;
pub(crate) mod state;
