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
//! A rule that needs the mesh is checked later and refused the same way by [`Body::refuse`].
//!
//! The crate knows no mesh: the crate `model` makes a body of a scene.
//!
//! One file of this crate per idea:
//! `document` is the TOML tree in which every value knows its key path and its place;
//! `text` lets serde fill structs from that tree, sets values in the text of a scene from outside of it, and shows places;
//! `section`, `scene`, `shared`, `body`, `loads` and `tie` are those structs, and so the list of all keys;
//! `check` has the rules on their values.
//! A new kind of load is a new variant in `loads`, of constraint in `section` and `body`; its rules are in `check`.
//! The kinds of histories, the effects and the schemes are those of `dynamics`; `check` has the rules on histories.

#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

mod alone;
mod body;
mod check;
mod document;
mod error;
mod file;
mod loads;
mod methods;
mod scene;
mod schema;
mod section;
mod shared;
mod text;
mod tie;

pub use body::constraint::{Constraint, HeldDirections, HingeLine, Region};
pub use body::effects::{Choice, Effects};
pub use body::measured::{Measured, MeasuredMode};
pub use body::modes::{About, Damping, Flexible, Large, Modes, Rayleigh};
pub use body::{Body, BodySource, FileBody, Frame, Initial, MeshedBody, Output, RigidBody, TiedMass};
pub use check::units::{BaseUnit, POUND_FORCE, UnitSize};
pub use document::join as key_path;
pub use dynamics::{Effect, EffectMap, LoadFrame, Method, Rows, Start, StepControl};
pub use error::SceneError;
pub use fem_tet10::{Material, Materials, PointMass};
pub use file::{text_from, text_of};
pub use loads::history::{DrivenSpeed, Formula, History, Interpolation, TablePoints};
pub use loads::load::{Load, LoadKind, LoadPlace};
pub use matrix_import::MatrixFiles;
pub use methods::{METHODS, method_named};
pub use scene::Scene;
pub use schema::json_schema;
pub use shared::{Shared, Time, Units};
pub use text::assign::{AssignError, assign, without};
pub use text::files::tables_of;
pub use text::place::Place;
pub use text::points::{PointsError, points_of};
pub use text::shorten::shorten;
pub use text::suggest::one_of;
pub use tie::joint::{
    AlongAndAbout, Bushing, Coupling, CouplingKind, End, Joint, JointDrive, JointKind, JointSpring, Locked, Spring,
};
pub use tie::marker::{GroundMarker, Marker, MarkerAxes, MarkerPlace, Tie};
