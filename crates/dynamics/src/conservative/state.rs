//! The state of the conservative form.

use nalgebra::{SVector, Vector3};
use rigid_kin::Attitude;

use crate::error::SetupError;

/// What moves slowly, beside the modes: see [`part`].
pub(crate) type Slow = SVector<f64, 20>;

/// First entries of the parts of [`Slow`].
pub(crate) mod part {
    /// Rotation vector since the start of the step, body axes.
    pub const THETA: usize = 0;
    /// Position of the origin, global.
    pub const POSITION: usize = 3;
    /// Linear momentum P of the motion of the origin, global.
    pub const MOMENTUM: usize = 6;
    /// Angular momentum π about the origin, one component for each axis of rotation.
    pub const PI: usize = 9;
    /// Work of the loads, and of what drives the body.
    pub const WORK: usize = 12;
    /// Energy that damping has taken.
    pub const DISSIPATION: usize = 13;
    /// Angular impulse of the loads about the origin, global.
    pub const ANGULAR_IMPULSE: usize = 14;
    /// Impulse of the loads, global.
    pub const IMPULSE: usize = 17;
}

pub(crate) fn get(slow: &Slow, first: usize) -> Vector3<f64> {
    slow.fixed_rows::<3>(first).into()
}

pub(crate) fn set(slow: &mut Slow, first: usize, value: &Vector3<f64>) {
    slow.fixed_rows_mut::<3>(first).copy_from(value);
}

/// State at a time.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ConservativeState {
    /// Time.
    pub time: f64,
    /// Attitude of the body frame.
    pub attitude: Attitude,
    pub(crate) slow: Slow,
    /// Angle about the axis of a hinge since the beginning, rad.
    pub(crate) turned: f64,
    /// Modal displacements q (nf).
    pub modal_displacement: Vec<f64>,
    /// Modal momenta p = q̇ + S ω (nf).
    pub modal_momentum: Vec<f64>,
}

impl ConservativeState {
    /// Takes over another state of the same body, without allocating.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.time = other.time;
        self.attitude = other.attitude;
        self.slow = other.slow;
        self.turned = other.turned;
        self.modal_displacement.copy_from_slice(&other.modal_displacement);
        self.modal_momentum.copy_from_slice(&other.modal_momentum);
    }

    /// Position of the body's origin, global components.
    pub fn origin_global(&self) -> Vector3<f64> {
        get(&self.slow, part::POSITION)
    }

    /// Linear momentum of the motion of the origin, global components: of a free body, that of the body.
    pub fn linear_momentum_global(&self) -> Vector3<f64> {
        get(&self.slow, part::MOMENTUM)
    }

    /// Angular momentum π about the origin, one component for each axis that the body turns about: the three body axes,
    /// or the axis of a hinge first.
    pub fn angular_momentum_body(&self) -> Vector3<f64> {
        get(&self.slow, part::PI)
    }

    /// Puts the origin to another place, global components.
    pub fn set_origin_global(&mut self, origin: &Vector3<f64>) {
        set(&mut self.slow, part::POSITION, origin);
    }

    /// Gives it another linear momentum, global components.
    pub fn set_linear_momentum_global(&mut self, momentum: &Vector3<f64>) {
        set(&mut self.slow, part::MOMENTUM, momentum);
    }

    /// Gives it another angular momentum, in the axes of [`Self::angular_momentum_body`].
    pub fn set_angular_momentum_body(&mut self, momentum: &Vector3<f64>) {
        set(&mut self.slow, part::PI, momentum);
    }

    /// Refuses lists of the wrong length and numbers that are not finite.
    pub(crate) fn check(&self, flexible: usize) -> Result<(), SetupError> {
        for (what, list) in [
            ("the list of modal displacements", &self.modal_displacement),
            ("the list of modal momenta", &self.modal_momentum),
        ] {
            if list.len() != flexible {
                return Err(SetupError::Length { what, expected: flexible, found: list.len() });
            }
        }
        let numbers = [&self.time, &self.turned].into_iter().chain(&self.slow).chain(&self.modal_displacement);
        match numbers.chain(&self.modal_momentum).copied().find(|x| !x.is_finite()) {
            Some(found) => Err(SetupError::Value { what: "a value of the state", found, expected: "a finite number" }),
            None => Ok(()),
        }
    }
}
