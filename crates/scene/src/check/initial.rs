//! The rules on `[initial]`.

use nalgebra::Vector3;
use rigid_kin::Attitude;

use super::Check;
use crate::body::Initial;
use crate::body::constraint::Constraint;
use crate::body::modes::Modes;
use crate::error::SceneError;

/// Sine of the angle between an initial velocity and the direction that is left, up to which it counts as rounding.
const ALONG: f64 = 1e-6;

/// The squares of larger numbers, summed and multiplied by a mass, may overflow.
const LARGEST: f64 = 1e140;

impl Check<'_> {
    pub fn initial(&self, initial: &Initial, modes: &Modes, constraint: Option<&Constraint>) -> Result<(), SceneError> {
        for (key, list) in [
            ("initial.modal_displacement", &initial.modal_displacement),
            ("initial.modal_velocity", &initial.modal_velocity),
        ] {
            self.not_more_than_modes(key, list.len(), modes.flexible)?;
        }
        let position = initial.position.unwrap_or_default();
        for (key, list) in [
            ("initial.position", &position[..]),
            ("initial.velocity", &initial.velocity[..]),
            ("initial.angular_velocity", &initial.angular_velocity),
            ("initial.modal_displacement", &initial.modal_displacement),
            ("initial.modal_velocity", &initial.modal_velocity),
        ] {
            if let Some(i) = list.iter().position(|value| value.abs() > LARGEST) {
                let expected = format!("a number of at most {LARGEST:e}, whose square is still a number");
                let help = "give what the body can have, in the units of the scene";
                self.require(false, &format!("{key}[{i}]"), &expected, help)?;
            }
        }
        if let Some(wxyz) = initial.attitude {
            let expected = "a quaternion [w, x, y, z] of finite numbers that are not all zero";
            let help = "[1, 0, 0, 0] has the body axes along the global ones; a turn by the angle a about the unit vector n \
                        is [cos(a/2), n sin(a/2)]";
            self.require(Attitude::from_wxyz(wxyz).is_ok(), "initial.attitude", expected, help)?;
        }
        let attitude = initial.attitude.and_then(|wxyz| Attitude::from_wxyz(wxyz).ok());
        let to_global = |direction: &[f64; 3]| -> [f64; 3] {
            attitude.map_or(*direction, |attitude| attitude.to_global(&Vector3::from(*direction)).into())
        };
        let Some(constraint) = constraint else { return Ok(()) };
        // What the constraint leaves of the velocity and of the angular velocity.
        let (velocity, angular_velocity) = match constraint {
            Constraint::Pin { .. } => (Left::Nothing("it follows from the angular velocity about the pin"), Left::All),
            Constraint::Hinge { motion: None, line, .. } => {
                (Left::Nothing("it follows from the angular velocity about the hinge"), Left::Along(line.direction()))
            }
            Constraint::Slider { motion: None, direction, .. } => {
                (Left::Along(to_global(direction)), Left::Nothing("a slider does not turn"))
            }
            Constraint::Clamp { .. } => (Left::Nothing("a clamped body stays"), Left::Nothing("a clamped body stays")),
            // What supports leave is known when the mesh is.
            Constraint::Support { .. } => (Left::All, Left::All),
            Constraint::Hinge { .. } | Constraint::Slider { .. } => {
                (Left::Nothing("`motion` gives it"), Left::Nothing("`motion` gives it"))
            }
        };
        self.left("initial.velocity", initial.velocity, velocity)?;
        self.left("initial.angular_velocity", initial.angular_velocity, angular_velocity)
    }

    fn left(&self, key: &str, value: [f64; 3], left: Left) -> Result<(), SceneError> {
        let value = Vector3::from(value);
        match left {
            Left::All => Ok(()),
            Left::Nothing(reason) => {
                let help = format!("remove it: {reason}");
                self.require(value == Vector3::zeros(), key, "0 with this constraint", &help)
            }
            Left::Along(direction) => {
                let across = value.cross(&Vector3::from(direction)).norm();
                let [x, y, z] = direction;
                let expected = format!("a multiple of [{x:.6}, {y:.6}, {z:.6}], the motion that the constraint leaves");
                self.require(across <= ALONG * value.norm(), key, &expected, "give the part along it")
            }
        }
    }
}

/// The part of a velocity that a constraint leaves.
enum Left {
    All,
    Along([f64; 3]),
    /// Nothing, for this reason.
    Nothing(&'static str),
}
