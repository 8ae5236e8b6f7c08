//! How a scene becomes a model: what it is built with, its mesh with supports and matrices, variants of it, and news of the work.

pub(crate) mod assembly;
pub(crate) mod builder;
pub(crate) mod progress;
pub(crate) mod variants;
