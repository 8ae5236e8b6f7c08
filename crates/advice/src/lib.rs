//! Which effects a motion calls for: estimated before it is computed, and checked on what happened.
//!
//! The answer is the motion of the modes and the attitude. An influence is relative to the largest deformation, or to the
//! angle turned (up to 1 rad), and it is an upper bound as long as it is small: what is called negligible is. It takes
//! into account that a small change of a frequency adds up for as long as a mode rings.
//!
//! The order of calls:
//!
//! 1. [`limits()`] refuses models that are known to have no rest or no meaning (again when the stiffness is known), and [`unsteady`]
//!    those that have no stable rest under their steady loads. Of the body itself only its elements can tell ([`RestOfBody`]).
//! 2. [`screen`] tells, from the modes alone, whether [`reduced_body::Constants::stress_stiffness`] may matter. If its row is
//!    on, compute that.
//! 3. [`advise`] gives the table: a [`Row`] for each [`Subject`], and what each mode is worth. Nothing stiffens where
//!    `deformed_inertia` is off: the stiffness is counted as part of it too. What only the reduced body can tell, such as
//!    the row of [`stress_row`] for the stress of the loads, goes into [`Advice::completed`].
//! 4. [`Backbone`]s of the modes whose [`Worth::strain_bound`] reaches the tolerance tell what linear strain makes of
//!    them, and with these [`Advice::large_modes`] which are to be large. [`step_estimate()`] gives the row of the step: which attitude or mode it gets wrong, and by how much.
//! 5. [`Review`] watches the run and names what has broken, and when.
//!
//! ```
//! use advice::{Case, Review, advise, limits, screen};
//! use fem_tet10::{Material, Materials, assemble, read_msh};
//! use dynamics::{Effect, EffectMap, Initial};
//! use modal::{Solver, Support};
//! use reduced_body::ReducedBody;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let mesh = read_msh(concat!(env!("CARGO_MANIFEST_DIR"), "/../../meshes/ring.msh"))?;
//! let steel = Material { young_modulus: 210e3, poisson_ratio: 0.3, density: 7.8e-9 };
//! let matrices = assemble(&mesh, &Materials::Uniform(steel), &[])?;
//! let solver = Solver::new(matrices.stiffness(), matrices.mass(), mesh.positions(), &Support::free())?;
//! let modes = solver.modes(4, |_| ())?;
//! let body = modes.reduced(matrices.mass(), mesh.positions())?;
//! let initial = Initial { omega: [0.0, 0.0, 1.0].into(), ..Initial::at_rest(4) };
//! let case = Case {
//!     body: &body,
//!     damping_ratios: &[0.01; 4],
//!     loads: &[],
//!     is_gravity: &[],
//!     drive: None,
//!     initial: &initial,
//!     end: 1.0,
//!     length: 200.0,
//!     length_unit: "mm",
//!     peaks: &[100.0; 4], // the largest of each column of `modes.shapes`
//!     static_compliances: &[],
//!     centrifugal_remainders: &[],
//!     drive_remainder: None,
//!     backbones: &[],
//!     manifold: None,
//!     coupling: None,
//! };
//! let effects = EffectMap::all();
//! assert_eq!(limits(&case, &effects)?, None);
//! if screen(&case, 1e-3)?.on {
//!     // compute body.stress_stiffness
//! }
//! let advice = advise(&case, 1e-3)?;
//! assert!(advice.effects[Effect::Rotation].on && !advice.effects[Effect::Translation].on);
//! let review = Review::new(case, effects, &advice);
//! // at each step of the run, by Simulation::advance_watched: review.look(&moment);
//! // for each observation: review.observe(&observation)?;
//! assert!(review.broken().is_empty());
//! # Ok(())
//! # }
//! ```
#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

mod limits;
mod motion;
mod review;
mod step;
mod strain;
mod table;

pub use limits::{Refusal, RestOfBody, limits, unsteady};
pub use motion::case::{AdviceError, Case, StaticCompliance};
pub use review::{Broken, Detuning, Review};
pub use step::{ModeError, StepEstimate, step_estimate};
pub use strain::backbone::{Backbone, DETUNED};
pub use strain::error::StrainError;
pub use strain::stress::{StressField, StressInfluence, StressSource, stress, stress_row};
pub use table::completed::Findings;
pub use table::row::{Row, Subject, Worth};
pub use table::rows::{Advice, advise, screen};
/// Crates whose types are in the interface.
pub use {dynamics, reduced_body};
