//! A flexible body in modal coordinates: plain numbers, none of the size of a mesh, and no solver.
//!
//! [`ReducedBody`] has every constant that the motion of a body needs, [`BodyPoint`] the shapes at a material point,
//! [`RigidMotion`] the rigid motions that a support leaves. A mesh is reduced by `modal::Modes::reduced`; a body from another
//! program comes by [`ReducedBody::from_constants`], one without modes by [`ReducedBody::rigid`].

#![deny(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

pub mod as_data;
mod body;
mod error;
mod large_products;
mod participation;
mod rigid;
mod rigid_motion;

pub use body::{BodyPoint, Constants, ReducedBody};
pub use error::BodyError;
pub use large_products::{LargeCoordinates, LargeProducts};
pub use participation::{OfBase, Participation};
pub use rigid_motion::{RigidMotion, Twist};
