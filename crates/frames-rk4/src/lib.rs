//! The paper's synthesis of travelling frames (X. Liu), as a formulation of `dynamics`.
//!
//! The body is followed in a sequence of inertial frames that travel with its rigid motion. One step of [`PaperScheme`] is
//! Eqs. (36) to (40) of the paper: the linear modal model
//!
//! ```text
//! η̇ = H η + {0, f_q},   η = {q, q̇}                                    (35)
//! ```
//!
//! is integrated in the inertial frame that coincides with the body now; the rigid part of the displacement goes to
//! the frame; everything else is turned into the frame that the rigid part has reached and projected back onto the
//! modes. The turn followed by the projection is `Σ R_ab E_ab` on the modal coordinates, so a step costs the same on
//! any mesh. See `docs/method/paper.md` for each equation beside its function.
//!
//! | paper | here |
//! |---|---|
//! | (17)–(22) rotation of the frame | [`rigid_kin::transformation_matrix`], [`rigid_kin::f_inverse`] |
//! | (28)–(31) modal expansion and its inverse, with the turn T | [`ModalRotation`] |
//! | (32)–(35) modal equations | [`ModalModel`] |
//! | (36), (37) ω by g and α by h | [`rigid_kin::ReferencePoints`] |
//! | k1 … k4, (38)–(40) | [`PaperScheme`] |
//!
//! [`PaperLimit`] steps the limit of that scheme for short steps, at fourth order. Both reach a run as a
//! [`Method`](dynamics::Method): [`PAPER`] and [`LIMIT`].
#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

mod attitude_account;
mod body_motion;
mod cross_products;
mod limit;
mod modal_rotation;
mod model;
mod state;
mod synthesis;
mod travelling_frame;

pub use body_motion::BodyMotion;
pub use limit::{LIMIT, PaperLimit};
pub use modal_rotation::ModalRotation;
pub use model::ModalModel;
pub use state::State;
pub use synthesis::{PAPER, Paper, PaperScheme};
pub use travelling_frame::TravellingFrame;

/// Crates whose types are in the interface.
pub use dynamics::{self, nalgebra, reduced_body, rigid_kin};
