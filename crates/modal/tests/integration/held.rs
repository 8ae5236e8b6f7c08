//! Held bodies.

pub(crate) mod held_bars;
pub(crate) mod held_dofs;
pub(crate) mod supported;
pub(crate) mod supports;
