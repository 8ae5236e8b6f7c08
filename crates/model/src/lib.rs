//! From the description of a scene to a body that can move.
//!
//! [`Model::build`] reads the mesh of a scene, finds its modes and reduces the body; [`Model::start`] begins the motion. A
//! [`Builder`] does so with a [`Cache`], or with another solver. An [`Assembly`] is the part that scenes share which differ in
//! their effects and modes, and its [`Variants`] are their models.
//!
//! | folder | concept |
//! |---|---|
//! | `body` | the body file: written for later runs and other programs, read where a scene names one |
//! | `cache` | results of the finite-element model, kept from run to run |
//! | `mesh` | mesh or matrices of a body, and doubts about them |
//! | `structure` | the finite-element model: modes, static responses, stress |
//! | `support`, `load`, `stress` | what holds the body, what acts on it, and the stress of that |
//! | `reduction` | `survey` (what the scene may need), `decide` (what it gets), `reduce` (make it); `reference` (the bent body that modes are about) |
//! | `model` | the reduced body with its points, markers and loads |
//! | `full` | the full nonlinear body of the scene, and the check of a model's state by it |
//! | `gradient` | rates of frequencies and answers with the numbers of a body |
//! | `tie` | markers, and the systems of the bodies that joints connect |

#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

mod body;
mod building;
mod cache;
mod error;
mod full;
mod gradient;
mod load;
mod mesh;
mod model;
mod needs;
mod reduction;
mod stress;
mod structure;
mod support;
mod tie;

pub use body::files::files_of_body;
pub use building::assembly::{Assembly, AssemblyInput};
pub use building::builder::Builder;
pub use building::progress::{BuildProgress, BuildTimes, BuildWork};
pub use building::variants::Variants;
pub use cache::{Cache, CacheNotes};
pub use error::{BuildError, StartError};
pub use full::acting::TieForce;
pub use full::check::{Checker, Course, FrequencyCheck, PointCheck, StateCheck};
pub use full::mends::{ErrorDirection, ErrorPart, Mend};
pub use full::stress::{BodyStressCheck, CheckedStress, StressCheck};
pub use full::{FullError, FullModel};
pub use gradient::in_joints::{BodyInJoints, RatesInJoints};
pub use gradient::load_rates::LoadRates;
pub use gradient::parameter::Parameter;
pub use gradient::rates::{BodyRates, ParameterRates, RatesOf, Residues};
pub use gradient::varied::VariedBody;
pub use load::mesh_load::BaseAcceleration;
pub use mesh::doubt::{Doubt, doubts};
pub use mesh::given::MatrixChecks;
pub use model::{Meshed, Model};
pub use needs::{ModeCount, Needs};
pub use stress::about::stress_about;
pub use stress::products::ProductStrains;
pub use stress::shapes::{BodyStress, StressPeak};
pub use support::reactions::SupportRows;
pub use tie::body_marker::{BodyMarker, MarkerPart, UnknownTurns};
pub use tie::tied::{Tied, physics_in_system, tie, tie_models};
pub use tie::warp::Warp;
