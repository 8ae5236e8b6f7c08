//! Small vibrations about a steady state.

pub(crate) mod at_state;
pub(crate) mod loaded;
pub(crate) mod own_coupling;
pub(crate) mod steady_spin;
