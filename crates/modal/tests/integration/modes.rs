//! Frequencies and shapes against closed forms, dense oracles and themselves.

pub(crate) mod by_nodes;
pub(crate) mod closed_forms;
pub(crate) mod convergence;
pub(crate) mod general_mass;
pub(crate) mod invariance;
pub(crate) mod oracles;
pub(crate) mod plate;
pub(crate) mod repeatability;
pub(crate) mod spectrum;
