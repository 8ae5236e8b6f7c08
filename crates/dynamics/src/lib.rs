//! The motion of a flexible body that has been reduced to modes.
//!
//! Begin with [`Simulation::builder`]. Two formulations can be stepped:
//!
//! * the conservative form in the mean-axis frame ([`ConservativeMotion`]), the default: momenta are its state, so energy
//!   and angular momentum are constants of the motion for any number of modes. Its equations are those of
//!   [`ConservativeBody`], and stand at the head of `conservative.rs`;
//! * the paper's ([`PaperScheme`]): inertial frames that travel with the rigid motion, after X. Liu.
//!
//! One step of [`PaperScheme`] is Eqs. (36) to (40) of the paper: the linear modal model
//!
//! ```text
//! η̇ = H η + {0, f_q},   η = {q, q̇}                                    (35)
//! ```
//!
//! is integrated in the inertial frame that coincides with the body now; the rigid part of the displacement goes to
//! the frame; everything else is turned into the frame that the rigid part has reached and projected back onto the
//! modes. The turn followed by the projection is `Σ R_ab E_ab` on the modal coordinates, so a step costs the same on
//! any mesh. See `docs/method.md` for each equation beside its function.
//!
//! | paper | here |
//! |---|---|
//! | (17)–(22) rotation of the frame | [`rigid_kin::transformation_matrix`], [`rigid_kin::f_inverse`] |
//! | (28)–(31) modal expansion and its inverse, with the turn T | [`ModalRotation`] |
//! | (32)–(35) modal equations | [`ModalModel`] |
//! | (36), (37) ω by g and α by h | [`rigid_kin::ReferencePoints`] |
//! | k1 … k4, (38)–(40) | [`PaperScheme`] |
#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

mod account;
mod allowance;
mod attitude_account;
mod blocked_matrix;
mod builder;
mod checkpoint;
mod column_major;
mod components;
mod conservative;
mod conservative_motion;
mod effect;
mod energies;
mod error;
mod error_size;
mod events;
mod exponential;
mod fingerprint;
mod formula_steps;
mod four;
mod history;
mod initial;
mod load;
mod loaded;
mod manifold;
mod methods;
mod modal_rotation;
mod model;
mod moment;
mod motion;
mod observation;
mod observer;
mod observers;
mod own_coupling;
mod paper;
mod paper_limit;
mod phi;
mod physics;
mod plan;
mod reaction;
mod scheme;
mod second_order;
mod setup;
mod side_by_side;
mod signal;
mod simulation;
mod spin_stiffness;
mod stack;
mod state;
mod steady_spin;
mod support_reactions;
mod symmetric;
mod travelling_frame;
mod work;

pub use builder::SimulationBuilder;
pub use checkpoint::{CheckpointError, decode, encode};
pub use conservative::{ConservativeBody, ConservativeRates, ConservativeState};
pub use conservative_motion::ConservativeMotion;
pub use effect::{Effect, EffectMap};
pub use energies::Energies;
pub use error::{SetupError, StepError};
pub use events::{Crossing, Event};
pub use history::{Expression, History, Table};
pub use initial::Initial;
pub use load::{
    Applied, BodyField, FieldLoad, Kinematics, Load, LoadFn, LoadFrame, Pattern, PointForce, PointMoment, ScaledLoad,
    SharedLoad,
};
pub use loaded::{LoadedError, LoadedMode};
pub use manifold::{MOST_LARGE, Manifold};
pub use modal_rotation::ModalRotation;
pub use model::ModalModel;
pub use moment::Moment;
pub use motion::{BodyMotion, PointShapes, RotationShapes};
pub use observation::{Observation, PointMotion};
pub use observer::{Observer, StepEnd};
pub use paper::PaperScheme;
pub use paper_limit::PaperLimit;
pub use physics::{Drive, DrivenMotion, DrivenSpeed, Physics};
pub use plan::{Rows, StepControl};
pub use reaction::Reaction;
pub use scheme::{ErrorEstimate, Scheme};
pub use second_order::SecondOrder;
pub use setup::{Method, Setup, StepLimit};
pub use signal::Signal;
pub use simulation::{Reached, Simulation, Stats};
pub use state::{MotionState, State};
pub use steady_spin::{EigenError, SpinMode, SteadySpin};
pub use support_reactions::SupportReactions;
pub use travelling_frame::TravellingFrame;
pub use work::Work;

/// Crates whose types are in the interface.
pub use {faer, modal, nalgebra, rigid_kin};
