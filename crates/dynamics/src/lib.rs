//! The motion of a flexible body that has been reduced to modes.
//!
//! Begin with [`Simulation::builder`]. The conservative form in the mean-axis frame ([`ConservativeBody`]) is the default: momenta
//! are its state, so energy and angular momentum are constants of the motion for any number of modes. Its equations stand at the
//! head of `conservative.rs`.
//!
//! [`Equations`] say what a [`State`] is and what its rates are, a [`Scheme`] how a step uses them; both can come from outside, and
//! a [`Method`] names them together. What is no scheme of rates is a [`Motion`] of its own: the crate `frames-rk4`, the paper's
//! synthesis of travelling frames, is the example.
#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

mod body;
mod conservative;
mod equations;
mod error;
mod history;
mod load;
mod matrix;
mod motion;
mod observation;
mod run;
mod scheme;
mod simulation;
mod state;
mod system;
mod tolerance;
mod vibration;

pub use body::center_of_mass::CenterOfMass;
pub use body::effect::{Effect, EffectMap};
pub use body::initial::Initial;
pub use body::model::check_model;
pub use body::motion_state::MotionState;
pub use body::patch_turn::PatchTurn;
pub use body::physics::{Drive, DrivenMotion, DrivenSpeed, Physics, ReferenceForces};
pub use body::second_order::SecondOrder;
pub use body::shapes::{PointShapes, RotationShapes};
pub use conservative::manifold::{MAX_FOLLOWING, MAX_LARGE, Manifold};
pub use conservative::{ConservativeBody, Evaluation as ConservativeEvaluation};
pub use equations::sizes::Sizes;
pub use equations::{Equations, ErrorNorm, Evaluation, Glance, Oscillators, PlainNorm, StepDone};
pub use error::{BodyName, CustomError, RateError, SetupError, StepError};
pub use history::{Expression, History, Table};
pub use load::signal::Signal;
pub use load::{
    Applied, BodyField, FieldLoad, InertialMotion, Kinematics, Load, LoadFn, LoadFrame, Pattern, PointForce,
    PointMoment, ScaledLoad, SharedLoad,
};
pub use motion::Motion;
pub use motion::facts::{Balance, MotionFacts, Stepping};
pub use observation::energies::{Energies, RunEnergies};
pub use observation::moment::Moment;
pub use observation::observer::{Observer, StepEnd};
pub use observation::reaction::Reaction;
pub use observation::support_reactions::SupportReactions;
pub use observation::system::SystemObservation;
pub use observation::work::Work;
pub use observation::{Observation, PointMotion};
pub use run::description::error::DescriptionError;
pub use run::description::{DescribedBody, RunDescription};
pub use run::island::Island;
pub use run::row_times::RowTimes;
pub use run::{IslandError, Run};
pub use scheme::abilities::Abilities;
pub use scheme::exponential::Exponential;
pub use scheme::runge_kutta::{Classical, RungeKutta, Tableau};
pub use scheme::{Scheme, Step};
pub use simulation::builder::SimulationBuilder;
pub use simulation::checkpoint;
pub use simulation::checkpoint::{CheckpointError, decode, encode};
pub use simulation::events::{Crossing, Event};
pub use simulation::plan::{Rows, StepControl};
pub use simulation::setup::{Begin, Beginning, Method, Setup, StepLimit};
pub use simulation::stats::Stats;
pub use simulation::{Reached, Simulation};
pub use state::{Layout, Rotation, State, attitude_at, vector_at};
pub use system::collocation::SystemScheme;
pub use system::description::System;
pub use system::element::law::{MarkerForce, MarkerLaw, RelativeMotion};
pub use system::element::springs::{Bushing, PointSpring};
pub use system::element::{ForceElement, SetDirection, Stored};
pub use system::joint::coordinate::{Coordinate, JointCoordinates};
pub use system::joint::coupling::{CoupledCoordinate, Coupling};
pub use system::joint::drive::JointDrive;
pub use system::joint::equation::{EquationValue, JointEquation, JointEquationFn, RelativePlace};
pub use system::joint::force::{Friction, JointForce, Stops};
pub use system::joint::law::{JointLaw, JointLawFn};
pub use system::joint::observation::{JointObservation, LineObservation};
pub use system::joint::row::Row;
pub use system::joint::work::JointWork;
pub use system::joint::{Joint, JointPart};
pub use system::marker::Marker;
pub use system::marker::motion::{MarkerChange, MarkerMotion, MarkerWrench};
pub use system::radau::{Failed, SystemMotion, Tried};
pub use system::relaxed::RelaxError;
pub use system::run::SystemRun;
pub use system::run::second_order::Branching;
pub use system::run::setup::{Assembled, ShapeLimit, Start, SystemSetup};
pub use tolerance::allowance::ErrorEstimate;
pub use tolerance::{ErrorKinds, ErrorMeasure, StatedError};
pub use vibration::loaded::{AtRest, LoadedError, LoadedMode};
pub use vibration::steady_spin::SteadySpin;
pub use vibration::system::{
    BodyStiffening, CommonSpin, Equilibrium, Linearization, ReactionRows, Rotor, RotorError, ScaledEquations, SpinMode,
    Spring, Stability, SteadyError, SteadyState, StiffenedMode, SystemMode, SystemParticipation, TurningJoint,
    Unbalance, Vibrations,
};

/// Crates whose types are in the interface.
pub use keys::{Key, Keyed};
pub use {faer, nalgebra, reduced_body, rigid_kin};
