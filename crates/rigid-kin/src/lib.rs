//! Rotations, the kinematics of a rigid body from linear motion, and exact rigid-body motion.
//!
//! A flexible body carries a rigid motion within its movement. Three of its points R, P, Q show
//! that motion as plain linear velocities and accelerations; this crate turns those into angular
//! velocity, angular acceleration and attitude, and holds the motion of a rigid body to compare
//! with. It works on 3-vectors only and knows nothing of meshes or modes.
//!
//! # The equations of the paper
//!
//! Numbers are those of X. Liu, "A Novel Approach for Flexible Body Dynamics Computation via
//! Synthesizing Incremental Motions in Reconfigured Inertial Frames".
//!
//! | equation | what it says | here |
//! |---|---|---|
//! | (4) | oblique unit vectors e1, e2, e3 of three points; rows of B | [`ReferencePoints::new`], [`ReferencePoints::oblique_from_body`] |
//! | (5)–(8), named g in (9) | angular velocity from relative velocities | [`ReferencePoints::angular_velocity`] |
//! | (10)–(13), named h in (14) | angular acceleration from relative accelerations | [`ReferencePoints::angular_acceleration`] |
//! | (15), (16) | rate of a relative velocity in body components | [`relative_velocity_rate`] |
//! | (17) | M̂ = −\[λ×\] | [`cross_matrix`] |
//! | (18), (19) | A = exp(θM̂), from global to body components | [`transformation_matrix`], back by [`rotation_vector`] |
//! | (20), (22) | rate of the rotation vector, named f⁻¹ | [`f_inverse`] |
//! | (21) | Ω = −\[ω×\] | [`cross_matrix`] |
//!
//! Beyond the paper:
//!
//! | what | here |
//! |---|---|
//! | attitude that is advanced step by step and never meets the singularity of (22) | [`Attitude`] |
//! | α = α_modal − J⁻¹(ω×Jω), which (10)–(14) are not | [`euler_angular_acceleration`] |
//! | a checked inertia tensor with its principal axes | [`Inertia`] |
//! | motion of a rigid body under forces, fourth order | [`RigidBody`] |
//! | free motion of a rigid body in closed form | [`TorqueFreeMotion`] |
//!
//! # Frames and signs
//!
//! *Global* components are those of the inertial frame, *body* components those of a frame fixed
//! in the body. The matrix `A` is passive: `v_body = A v_global`; its rows are the body axes. A
//! rotation vector θ is λ·θ, axis times angle in radians; it has the same components in both
//! frames, as the axis does not move. With the angular velocity ω in body components
//!
//! ```text
//! A(θ) = exp(−[θ×]),      dA/dt = −[ω×] A,
//! θ' = ω + ½ θ×ω + (1 − (θ/2) cot(θ/2))/θ² · θ×(θ×ω)
//! ```
//!
//! The last line is singular at θ = 2π. A long motion therefore keeps an [`Attitude`] and lets
//! every step's rotation vector start at zero ("re-anchoring"):
//!
//! ```
//! use nalgebra::Vector3;
//! use rigid_kin::Attitude;
//!
//! let omega_body = Vector3::new(0.0, 0.0, 2.0);
//! let step = 0.01;
//! let mut attitude = Attitude::identity();
//! for _ in 0..1000 {
//!     attitude = attitude.advanced_by(&(omega_body * step));
//! }
//! let expected = Attitude::identity().advanced_by(&(omega_body * 10.0));
//! assert!(attitude.angle_to(&expected) < 1e-12);
//! ```
//!
//! Units are any consistent set; angles are radians. Nothing here panics: what cannot be computed
//! is refused by an error that says what was found and how to mend it.

#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

mod attitude;
mod elliptic;
mod inertia;
mod reference_points;
mod rigid_body;
mod rotation;
#[cfg(test)]
mod samples;
mod torque_free;

pub use attitude::{Attitude, NotAQuaternion};
pub use inertia::{Inertia, InertiaError};
/// The crate whose types are in the interface.
pub use nalgebra;
pub use reference_points::{CollinearPoints, ReferencePoints, euler_angular_acceleration, relative_velocity_rate};
pub use rigid_body::{RigidBody, RigidBodyError, RigidState, RigidStepError, Wrench};
pub use rotation::{
    BeyondFullTurn, NotARotation, cross_matrix, f_inverse, half_cotangent_factor, rotation_vector,
    transformation_matrix,
};
pub use torque_free::{Regime, TorqueFreeError, TorqueFreeMotion, TorqueFreeState};
