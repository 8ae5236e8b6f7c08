//! Sealed files: datasets of numbers whose every part is checked when it is read.
//!
//! A sealed file is an ordinary HDF5 file with contiguous datasets, so that h5py and the like read it. flexframe reads it without
//! HDF5, which may crash on damaged files: a head in front of the HDF5 part says where each dataset is, and has a hash of it, and
//! of all the rest. [`Made`] makes a file with room for datasets, [`SealedFile`] reads one and writes to its datasets in place,
//! [`Writer`] writes one that appears under its name when it is whole.
//!
//! The crate knows arrays and texts only: no mesh, no mode.

#![deny(unsafe_code)] // not `forbid`, since a macro of ndarray allows it within itself
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

mod array;
mod error;
mod file;
mod format;
mod head;
mod make;
mod writer;

pub use array::{Array, Kind, Number, little_endian};
pub use error::SealedError;
pub use file::SealedFile;
pub use format::Format;
pub use make::{Declared, Made, write_text};
pub use writer::Writer;
