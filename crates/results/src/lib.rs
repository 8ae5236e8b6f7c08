//! Results of a run: streamed HDF5 files and their reader.
//!
//! [`Writer`] appends one [`Sample`] per output step to an HDF5 file while the run goes on;
//! [`Results`] reads such a file back, finished or not. [`mod@layout`] is the list of all columns,
//! shared by both.
//!
//! The crate knows plain data only: no mesh, no mode, no scheme.

#![deny(unsafe_code)] // not `forbid`, since a macro of ndarray allows it within itself
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

mod checkpoint;
mod description;
mod error;
pub mod layout;
mod metadata;
mod place;
mod reader;
mod room;
mod sample;
mod seal;
mod store;
mod structure;
mod writer;

#[cfg(test)]
extern crate self as results; // for what the tests share

pub use error::FileError;
pub use metadata::{BodyProperties, Metadata, Units};
pub use reader::{PointHistory, Results, Table};
pub use sample::{PointSample, Sample};
pub use writer::{Expected, Resumed, Writer, unfinished};
