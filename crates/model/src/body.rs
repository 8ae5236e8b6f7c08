//! The body file, and the files that a body is read from.

pub(crate) mod files;
pub(crate) mod given;
pub(crate) mod origin;
mod writer;
