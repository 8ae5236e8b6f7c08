//! The state of a motion in the frame of the moment.

use modal::ReducedBody;
use nalgebra::Vector3;
use rigid_kin::Attitude;
use serde::{Deserialize, Serialize};

use crate::checkpoint::{CheckpointError, expect, finite};
use crate::error::SetupError;
use crate::initial::Initial;

/// A state in quantities that every formulation has.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionState {
    /// Time.
    pub time: f64,
    /// Attitude of the body frame.
    pub attitude: Attitude,
    /// Position of the body's origin, global components.
    pub origin_global: Vector3<f64>,
    /// Velocity of the body's origin, global components.
    pub velocity_global: Vector3<f64>,
    /// Angular velocity of the body frame, body components.
    pub omega_body: Vector3<f64>,
    /// Flexible modal displacements (nf).
    pub modal_displacement: Vec<f64>,
    /// Their rates as seen from the body frame (nf).
    pub modal_velocity: Vec<f64>,
}

impl MotionState {
    /// Refuses lists of the wrong length and numbers that are not finite.
    pub(crate) fn check(&self, flexible: usize) -> Result<(), SetupError> {
        for (what, list) in [
            ("the list of modal displacements", &self.modal_displacement),
            ("the list of modal velocities", &self.modal_velocity),
        ] {
            if list.len() != flexible {
                return Err(SetupError::Length { what, expected: flexible, found: list.len() });
            }
        }
        let Self { time, origin_global, velocity_global, omega_body, modal_displacement, modal_velocity, .. } = self;
        let vectors = [origin_global, velocity_global, omega_body].into_iter().flatten();
        let numbers = std::iter::once(time).chain(vectors).chain(modal_displacement).chain(modal_velocity);
        match numbers.copied().find(|x| !x.is_finite()) {
            Some(found) => Err(SetupError::Value { what: "a value of the state", found, expected: "a finite number" }),
            None => Ok(()),
        }
    }
}

/// State at one time, in the inertial frame that coincides with the (dummy) rigid body then.
///
/// Modal lists have 6+nf entries: three translations, three rotations, then the flexible modes. They are components
/// in this frame, of motion relative to global space (η of Eq. 33), not to the body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Time.
    pub time: f64,
    /// Attitude of the frame.
    pub attitude: Attitude,
    /// Where the frame's origin is, global components; at the beginning it is the centre of mass.
    pub origin_global: Vector3<f64>,
    /// Modal displacements q. The rigid ones are the remainder that the frame has not taken.
    pub modal_displacement: Vec<f64>,
    /// Modal velocities q̇.
    pub modal_velocity: Vec<f64>,
    /// Modal accelerations q̈.
    pub modal_acceleration: Vec<f64>,
    /// Angular velocity of the dummy rigid body by g, Eq. (36), body components.
    pub omega_body: Vector3<f64>,
    /// Its angular acceleration by h, Eq. (37), body components. See [`rigid_kin::ReferencePoints`] for its limits.
    pub alpha_body: Vector3<f64>,
}

impl State {
    /// The state at the beginning, its rates still to be found.
    pub(crate) fn begin(body: &ReducedBody, initial: &Initial) -> Result<Self, SetupError> {
        let (modal_displacement, modal_velocity) = initial.modal_state(body)?;
        Ok(Self {
            time: 0.0,
            attitude: initial.attitude,
            origin_global: body.origin,
            modal_acceleration: vec![0.0; modal_velocity.len()],
            modal_displacement,
            modal_velocity,
            omega_body: Vector3::zeros(),
            alpha_body: Vector3::zeros(),
        })
    }

    /// Takes over another state of the same body, without allocating.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        let Self { time, attitude, origin_global, omega_body, alpha_body, .. } = other;
        (self.time, self.attitude, self.origin_global) = (*time, *attitude, *origin_global);
        (self.omega_body, self.alpha_body) = (*omega_body, *alpha_body);
        self.modal_displacement.copy_from_slice(&other.modal_displacement);
        self.modal_velocity.copy_from_slice(&other.modal_velocity);
        self.modal_acceleration.copy_from_slice(&other.modal_acceleration);
    }

    /// Refuses lists of the wrong length and numbers that are not finite.
    pub(crate) fn check(&self, modes: usize) -> Result<(), CheckpointError> {
        let Self { time, origin_global, modal_displacement, modal_velocity, modal_acceleration, .. } = self;
        let modal = [modal_displacement, modal_velocity, modal_acceleration];
        expect("a list of modes", modal.iter().all(|list| list.len() == modes))?;
        let vectors = [origin_global, &self.omega_body, &self.alpha_body].into_iter().flatten();
        finite("the state", std::iter::once(time).chain(vectors).chain(modal.into_iter().flatten()))
    }
}

/// The three translations of a modal list.
pub(crate) fn translation(modal: &[f64]) -> Vector3<f64> {
    Vector3::new(modal[0], modal[1], modal[2])
}

/// The three rotations of a modal list.
pub(crate) fn rotation(modal: &[f64]) -> Vector3<f64> {
    Vector3::new(modal[3], modal[4], modal[5])
}
