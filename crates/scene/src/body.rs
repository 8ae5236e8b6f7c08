//! The body: the constraints that hold it, the modes kept, the effects simulated.

pub(crate) mod constraint;
pub(crate) mod effects;
pub(crate) mod measured;
pub(crate) mod modes;
