//! Modes and reduced bodies of whole meshes.

mod beam;
mod bodies;
mod held;
mod modes;
mod participation;
mod rates;
mod reduced_body;
mod refusals;
mod rigid_body;
mod statics;
