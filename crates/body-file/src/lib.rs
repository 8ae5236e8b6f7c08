//! Numbers of a reduced body in an HDF5 file whose every dataset is checked when it is read.
//!
//! [`Writer`] makes a file of declared datasets, [`BodyFile`] reads one. A file is an ordinary HDF5 file with contiguous
//! datasets, so that h5py and the like read it. flexframe reads it without HDF5, which may crash on damaged files: a head in
//! front of the HDF5 part says where each dataset is, and has a hash of it. A file appears under its name when it is whole.
//!
//! The crate knows arrays and texts only: no mesh, no mode.

#![deny(unsafe_code)] // not `forbid`, since a macro of ndarray allows it within itself
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

mod array;
mod error;
mod head;
mod reader;
mod writer;

pub use array::{Array, Kind, Number};
pub use error::BodyFileError;
pub use reader::BodyFile;
pub use writer::{Declared, Writer};
