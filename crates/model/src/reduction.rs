//! From the finite-element model of a scene to the reduced body: a survey, a decision, and the reduction.

pub(crate) mod about;
pub(crate) mod bent;
mod damping;
mod decide;
pub(crate) mod measured;
pub(crate) mod mesh_model;
pub(crate) mod meshed;
pub(crate) mod modal_model;
pub(crate) mod physics;
mod reduce;
pub(crate) mod reference;
pub(crate) mod rigid;
mod survey;
