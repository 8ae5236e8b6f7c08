//! Lines over axes.

pub(crate) mod axis;
pub(crate) mod grid;
pub(crate) mod inset;
pub(crate) mod lines;
pub(crate) mod path;
pub(crate) mod plot;
pub(crate) mod series;
pub mod stack;
