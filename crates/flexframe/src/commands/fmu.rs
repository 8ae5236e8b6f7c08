//! `flexframe fmu`: a body that moves in other programs, as an FMU of FMI 2.0 for co-simulation.
//!
//! An FMU is a zip file: `modelDescription.xml`, the library of the crate `fmi` under `binaries/`, and under `resources/`
//! what the library reads: the scene, its body file and its tables, and a [`Manifest`] of them. The program that packs it and
//! the library that runs it make their list of [`Variable`]s of the same [`FmuModel`], so that numbers of variables agree.

mod description;
mod library;
mod manifest;
mod model;
mod pack;
mod packed_scene;
mod si_unit;
mod variables;

pub use library::{library_path, marker};
pub use manifest::{MANIFEST, Manifest, PackedBody};
pub use model::{FmuBody, FmuModel};
pub use pack::{FmuReport, FmuSettings, pack, scene_of_body};
pub use variables::{Input, InputKind, Source, Variable};
