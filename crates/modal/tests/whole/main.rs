//! Modes and reduced bodies of whole meshes.

mod beam;
mod bodies;
mod by_nodes;
mod closed_forms;
mod convergence;
mod engine;
mod fields;
mod general_mass;
mod held;
mod held_bars;
mod held_dofs;
mod invariance;
mod oracles;
mod plate;
mod reduced_body;
mod refusals;
mod repeatability;
mod rigid_body;
mod spectrum;
mod static_shapes;
mod statics;
mod stress;
mod supports;
