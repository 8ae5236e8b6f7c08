//! Results of a run: streamed HDF5 files, their reader, and figures.
//!
//! * [`Writer`] appends one [`Sample`] per output step to an HDF5 file while the run goes on;
//!   [`Results`] reads such a file back, finished or not. [`mod@layout`] is the list of all columns,
//!   shared by both.
//! * [`LineChart`], [`ShapeGrid`] and [`Animation`] draw figures as SVG, PNG and GIF.
//! * [`boundary_triangles`] and [`sharp_edges`] turn a mesh into what the figures draw.
//!
//! The crate knows plain data only: no mesh, no mode, no scheme.

#![deny(unsafe_code)] // not `forbid`, since a macro of ndarray allows it within itself
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

mod animation;
mod chart;
mod checkpoint;
mod description;
mod error;
mod font;
pub mod layout;
mod metadata;
mod picture;
mod place;
mod reader;
mod render;
mod sample;
mod seal;
mod shapes;
mod store;
mod structure;
mod surface;
mod ticks;
mod view;
mod writer;

#[cfg(test)]
extern crate self as results; // for what the tests share
#[cfg(test)]
mod test_body;

pub use animation::{Animation, Frame};
pub use chart::{LineChart, Scale, Series, Stroke};
pub use error::{FigureError, FileError};
pub use metadata::{BodyProperties, Metadata, Units};
pub use reader::{PointHistory, Results, Table};
pub use sample::{PointSample, Sample};
pub use shapes::{Panel, ShapeGrid};
pub use surface::{boundary_triangles, sharp_edges};
pub use view::View;
pub use writer::{Expected, Resumed, Writer, unfinished};
