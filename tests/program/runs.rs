//! Runs, their rows and the means that they take.

pub(crate) mod alone;
pub(crate) mod bodies;
pub(crate) mod memory;
pub(crate) mod peak_memory;
pub(crate) mod reactions;
pub(crate) mod ring_down;
pub(crate) mod rows;
pub(crate) mod spin_up;
pub(crate) mod threads;
pub(crate) mod tied;
