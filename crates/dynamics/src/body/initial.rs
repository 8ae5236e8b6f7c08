//! How a motion begins.

use keys::{Key, Keyed};
use nalgebra::Vector3;
use reduced_body::ReducedBody;
use rigid_kin::Attitude;

use crate::body::motion_state::MotionState;
use crate::error::SetupError;

/// State at the beginning.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Initial {
    /// Attitude of the body frame.
    pub attitude: Attitude,
    /// Position of the body's origin, global components; `None` is where the mesh has it.
    pub origin: Option<Vector3<f64>>,
    /// Velocity of the frame's origin (the centre of mass), global components.
    pub velocity: Vector3<f64>,
    /// Angular velocity of the body frame, body components.
    pub omega: Vector3<f64>,
    /// Flexible modal displacements (nf).
    pub modal_displacement: Vec<f64>,
    /// Rates of the flexible modal displacements as seen from the body frame (nf).
    pub modal_velocity: Vec<f64>,
}

impl Initial {
    /// At rest and undeformed.
    pub fn at_rest(flexible: usize) -> Self {
        Self {
            attitude: Attitude::identity(),
            origin: None,
            velocity: Vector3::zeros(),
            omega: Vector3::zeros(),
            modal_displacement: vec![0.0; flexible],
            modal_velocity: vec![0.0; flexible],
        }
    }

    /// The same as the state of a body at time 0.
    pub fn state(self, body: &ReducedBody) -> MotionState {
        let Self { attitude, origin, velocity, omega, modal_displacement, modal_velocity } = self;
        MotionState {
            time: 0.0,
            attitude,
            origin_global: origin.unwrap_or(body.origin),
            velocity_global: velocity,
            omega_body: omega,
            modal_displacement,
            modal_velocity,
        }
    }

    /// Refuses lists of the wrong length and numbers that are not finite.
    ///
    /// # Errors
    /// [`SetupError`].
    pub fn check(&self, flexible: usize) -> Result<(), SetupError> {
        for (what, list) in [
            ("the list of initial modal displacements", &self.modal_displacement),
            ("the list of initial modal velocities", &self.modal_velocity),
        ] {
            if list.len() != flexible {
                return Err(SetupError::Length { what, expected: flexible, found: list.len() });
            }
        }
        let numbers = self
            .origin
            .iter()
            .flat_map(|origin| origin.iter())
            .chain(&self.velocity)
            .chain(self.omega.iter())
            .chain(&self.modal_displacement);
        match numbers.chain(&self.modal_velocity).copied().find(|x| !x.is_finite()) {
            Some(found) => Err(SetupError::Value { what: "an initial value", found, expected: "a finite number" }),
            None => Ok(()),
        }
    }
}

impl From<&MotionState> for Initial {
    fn from(state: &MotionState) -> Self {
        Self {
            attitude: state.attitude,
            origin: Some(state.origin_global),
            velocity: state.velocity_global,
            omega: state.omega_body,
            modal_displacement: state.modal_displacement.clone(),
            modal_velocity: state.modal_velocity.clone(),
        }
    }
}

impl Keyed for Initial {
    fn key(&self, key: Key) -> Key {
        let Self { attitude, origin, velocity, omega, modal_displacement, modal_velocity } = self;
        key.of("start", 1)
            .with("attitude", &attitude.wxyz())
            .with("origin", origin)
            .with("velocity", velocity)
            .with("omega", omega)
            .with("modal displacement", modal_displacement)
            .with("modal velocity", modal_velocity)
    }
}
