//! The body as it is drawn: what a run stores of it in its results file, and what comes after reads from there.

mod hash;
mod of_body_file;
mod of_model;
mod opened;
mod solid;
mod stored;

pub(crate) use of_model::{shapes_of, surface_shapes_of};
pub(crate) use opened::{Drawn, DrawnBody, Part, body_files};
pub(crate) use stored::{mesh_properties, not_stored, stored_bytes, stored_shapes};
