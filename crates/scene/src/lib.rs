//! The scene file: read, and checked.
//!
//! A scene is a TOML file that says everything about one run: the body (mesh, materials, point
//! masses), the modes kept, the loads, the time step and what is written out.
//! [`Scene::read`] gives it as plain data that obeys every rule which needs no mesh; whatever
//! breaks a rule is refused by a [`SceneError`] that shows file, line, key, what was found, what
//! was expected and help:
//!
//! ```text
//! plate.toml:34:1: `time.stpe`: unknown key `stpe`; did you mean `step`?
//!    |
//! 34 | stpe = 1e-4
//!    | ^^^^
//!    = rename it to `step` (possible here: `end`, `step`, `tolerance`, `formulation`, `scheme`)
//! ```
//!
//! A rule that needs the mesh is checked later and refused the same way by [`Scene::refuse`].
//!
//! The crate knows no mesh: the crate `model` makes a body of a scene.
//!
//! One file of this crate per idea:
//! `document` is the TOML tree in which every value knows its key path and its place;
//! `deserialize` lets serde fill structs from that tree;
//! `section`, `tie_section`, `scene`, `modes`, `effects`, `constraint`, `load`, `history`, `marker` and `joint` are those
//! structs, and so the list of all keys;
//! `check` has the rules on their values;
//! `assign` sets values in the text of a scene from outside of it.
//! A new kind of load is a new variant in `load`, of constraint in `section` and `constraint`; its rules are in `check`.
//! The kinds of histories, the effects and the schemes are those of `dynamics`; `check` has the rules on histories.

#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

mod alone;
mod assign;
mod check;
mod constraint;
mod deserialize;
mod document;
mod effects;
mod error;
mod example;
mod file;
mod files;
mod history;
mod joint;
mod load;
mod marker;
mod methods;
mod modes;
mod name;
mod ordinary_file;
mod place;
mod scene;
mod section;
mod shape;
mod shorten;
mod suggest;
mod system;
mod tie_section;
mod unit_vector;

pub use assign::{AssignError, assign};
pub use constraint::{Constraint, HeldDirections, HingeLine, Region};
pub use document::join as key_path;
pub use dynamics::{Effect, EffectMap, LoadFrame, Method, Rows, StepControl};
pub use effects::{Choice, Effects};
pub use error::SceneError;
pub use fem_tet10::{Material, Materials, PointMass};
pub use file::{text_from, text_of};
pub use history::{DrivenSpeed, Formula, History, TablePoints};
pub use joint::{
    AlongAndAbout, Bushing, Coordinate, Coupling, CouplingKind, End, Friction, Joint, JointDrive, JointKind,
    JointSpring, Locked, Spring, Stops,
};
pub use load::{BaseAcceleration, Force, Gravity, Load, Moment, Pressure, Traction};
pub use marker::{GroundMarker, Marker, MarkerAxes, MarkerPlace};
pub use matrix_import::MatrixFiles;
pub use methods::{METHODS, method_named};
pub use modes::{Damping, Flexible, Large, Modes, Rayleigh};
pub use place::Place;
pub use scene::{Body, FileBody, Frame, Initial, MeshedBody, Output, RigidBody, Scene, Time, Units};
pub use shorten::shorten;
pub use suggest::one_of;
pub use system::System;
