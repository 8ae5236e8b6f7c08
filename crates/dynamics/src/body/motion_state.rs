//! The state of a motion in quantities that every formulation has.

use nalgebra::Vector3;
use rigid_kin::Attitude;

use crate::error::SetupError;

/// A state in quantities that every formulation has.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
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
    /// The state in a list of one body.
    ///
    /// # Errors
    /// [`SetupError::Length`] for a list of another length.
    pub fn only(states: &[Self]) -> Result<&Self, SetupError> {
        match states {
            [state] => Ok(state),
            _ => Err(SetupError::Length { what: "the list of states", expected: 1, found: states.len() }),
        }
    }

    /// Refuses lists of the wrong length and numbers that are not finite.
    ///
    /// # Errors
    /// [`SetupError`].
    pub fn check(&self, flexible: usize) -> Result<(), SetupError> {
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
