//! Results of a run: streamed HDF5 files and their reader.
//!
//! [`Writer`] appends one row per output step to an HDF5 file while the run goes on; [`Results`] reads such a file back,
//! finished or not. Both are given a table of [`Column`]s, which says what a row holds and how to get it from the
//! caller's own type of row: a [`SystemRow`].
//!
//! A file with T rows has the dataset `time`, one dataset in the group `system` for each column of the system, and one in
//! `bodies/NAME` for each column of a body, but for those that ask for a part that the body has not got. All points of a
//! body are in one dataset of T×P×3, and `points/names` and `points/position` (P×3) say which they are. `model` has `mass`,
//! `center_of_mass` (3), `inertia` (3×3), `origin` (3), `frequencies`, `damping_ratios` and `kinds` (nf), `rotation_axes` and
//! `translation_axes` (…×3) besides, and the [`Shapes`] of the body, which is what is drawn of it: with these and the rows,
//! all that comes after a run needs this one file. Where there is a single body, the root has links to all that is in its
//! group.
//!
//! Every dataset has the attributes `unit`, `frame` and `description`. The root has `title`, `scene` (the scene
//! file's text), `scene_file` (where it was), `formulation`, `scheme`, `step` or `tolerance`, `program_version`,
//! `units_length`, `units_mass`, `units_time` and `complete`: 1, or 0 in an unfinished file.
//!
//! In an unfinished file, T is the number of rows that there is room for. The time of those that have not been written is
//! NaN, and what stands beside it means nothing. It has the dataset `checkpoint` besides (2×words): two places for the
//! state of the run, written in turns, each with its number, the rows before it, their check sum, the words of the state,
//! and a check sum of itself.
//!
//! For ParaView there are [`VtkHdf`], and [`write_vtu`] with [`write_pvd`] for versions before 5.12.
//!
//! The crate knows plain data only: no mesh, no mode, no scheme.

#![deny(unsafe_code)] // not `forbid`, since a macro of ndarray allows it within itself
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

mod block;
mod checkpoint;
mod column;
mod container;
mod dimension;
mod error;
mod history;
pub mod kind;
mod metadata;
mod paraview;
mod reader;
mod shapes;
mod writer;

#[cfg(test)]
extern crate self as results; // for what the tests share

pub use column::{Column, Components, Quantities, Quantity, Role, Scope, SystemRow, Values};
pub use dimension::Dimension;
pub use error::FileError;
pub use history::{History, histories};
pub use metadata::{
    BodyMetadata, BodyProperties, EffectProperties, JointMetadata, MeshProperties, Metadata, TrustLine, Units,
};
pub use paraview::fields::{CellKind, Field, Grid};
pub use paraview::vtkhdf::{Block, VtkHdf};
pub use paraview::vtu::{PvdEntry, write_pvd, write_vtu};
pub use reader::{BodyResults, ColumnTable, Results};
pub use shapes::{Shapes, StressShapes};
pub use writer::{Expected, Resumed, Writer, bytes_per_row, replace_trust, unfinished};
