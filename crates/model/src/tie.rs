//! Ties between bodies: places with axes on them, and the systems of those that joints connect.

mod axes;
pub(crate) mod body_marker;
mod ends;
mod islands;
pub(crate) mod mesh_marker;
mod pairs;
mod patterns;
pub(crate) mod place;
pub(crate) mod tied;
pub(crate) mod warp;
