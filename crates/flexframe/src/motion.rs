//! How the run of a scene begins. Every command that moves bodies moves them by such a run.

mod beginning;
pub(crate) mod described;

pub(crate) use beginning::begin_tied;
pub use beginning::{BeginError, BodyForces, JointForces, MarkerForces, OwnEquation, StartSettings, begin};
