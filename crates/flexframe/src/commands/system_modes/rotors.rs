//! Rotors that spin in the motion of a scene, of which linear answers have the gyroscopic moments.

use dynamics::{CommonSpin, Rotor, RotorError, SteadyError, SteadyState, SystemMotion, TurningJoint};
use serde::Serialize;

use crate::report::quantity;

/// A rotor that spins.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpinningRotor {
    /// Name of its joint.
    pub joint: String,
    /// Speed against what carries it, radians per time.
    pub speed: f64,
}

impl SpinningRotor {
    /// In words.
    pub(crate) fn words(&self, time: &str) -> String {
        format!("a rotor that spins at {} rad/{time} in joint {}", quantity(self.speed), self.joint)
    }
}

/// Rate of a turn, as a part of the slowest circular frequency, from which leaving it out is told: its centrifugal forces change that by half
/// the square.
const TOLD: f64 = 0.03;

/// The rotors of a motion, and joints that turn and spin none.
pub(crate) struct Rotors {
    pub spinning: Vec<(Rotor, f64)>,
    pub found: Vec<SpinningRotor>,
    left_out: Vec<(String, f64, RotorError)>,
}

impl Rotors {
    /// The rotors that a motion spins, with the joints that turn for another reason.
    pub fn of(motion: &SystemMotion, is_another: impl Fn(usize) -> bool) -> Self {
        let mut rotors = Self { spinning: Vec::new(), found: Vec::new(), left_out: Vec::new() };
        for TurningJoint { joint, rate, rotor } in motion.turning_joints() {
            if is_another(joint) {
                continue;
            }
            let name = motion.system().joints()[joint].name.clone();
            match rotor {
                // A rotor in two bearings is one.
                Ok((rotor, _)) if rotors.spinning.iter().any(|(of, _)| of.body == rotor.body) => {}
                Ok((rotor, speed)) => {
                    rotors.spinning.push((rotor, speed));
                    rotors.found.push(SpinningRotor { joint: name, speed });
                }
                Err(error) => rotors.left_out.push((name, rate, error)),
            }
        }
        rotors
    }

    /// Sentences about turns that are left out, beside vibrations of these circular frequencies.
    pub fn warnings(&self, frequencies: impl Iterator<Item = f64>) -> Vec<String> {
        let slowest = frequencies.filter(|omega| *omega > 0.0).reduce(f64::min).unwrap_or(0.0);
        let told = self.left_out.iter().filter(|(_, rate, _)| rate.abs() > TOLD * slowest);
        told.map(|(name, rate, error)| {
            format!(
                "joint {name} turns at {} rad per time, which is left out, for it spins no rotor: {error}",
                quantity(*rate)
            )
        })
        .collect()
    }

    /// The steady state in a common spin of what carries them.
    pub fn steady_state(&self, motion: &SystemMotion, spin: &CommonSpin) -> Result<SteadyState, SteadyError> {
        motion.steady_state_with_rotors(spin, self.spinning.iter().map(|(rotor, speed)| (rotor, *speed)))
    }
}
