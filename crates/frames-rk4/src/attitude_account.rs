//! Account of the attitude: it is lost where it turns by what no load has caused.
//!
//! The start and the loads account for the angular momentum. A scheme that does not keep it turns the body by the spin
//! that belongs to the difference, step after step. These turns add up to how far the attitude is off: in global axes, as
//! small rotations do, so that those to and fro of a vibration cancel.

use dynamics::StepError;
use dynamics::checkpoint::{CheckpointError, equal_room, finite};
use dynamics::nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Angle in rad, of turns that no load has caused, beyond which nothing is known about the attitude. Where the
/// account of `examples/tumbling_plate.toml` by the paper's scheme comes to this, its attitude is off by 1.4.
const LOST: f64 = 1.0;

/// The account of a run.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub(crate) struct AttitudeAccount {
    /// Angular momentum at the start, global components, and the time up to which the angle is known.
    #[serde(with = "equal_room")]
    start: Option<(Vector3<f64>, f64)>,
    /// Sum of the turns that nothing accounts for, rad, global components.
    turn_global: Vector3<f64>,
}

impl AttitudeAccount {
    /// Refuses numbers that are not finite.
    pub(crate) fn check_saved(&self) -> Result<(), CheckpointError> {
        let (momentum, time) = self.start.unwrap_or_default();
        finite("the account of the attitude", momentum.iter().chain(&self.turn_global).chain([&time]))
    }

    /// Checks the angular momentum less the impulse of the loads, `balance_global`, at a time; `spin_of` is the spin
    /// that the body has by an angular momentum, both in global components. The `step` is the longest so far.
    ///
    /// # Errors
    /// [`StepError::Attitude`].
    pub(crate) fn check(
        &mut self,
        time: f64,
        balance_global: Vector3<f64>,
        spin_of: impl Fn(&Vector3<f64>) -> Vector3<f64>,
        step: f64,
    ) -> Result<(), StepError> {
        let (start, until) = self.start.get_or_insert((balance_global, time));
        self.turn_global += spin_of(&(balance_global - *start)) * (time - *until);
        *until = time;
        let angle = self.turn_global.norm();
        // Written so that NaN is found too.
        if angle <= LOST { Ok(()) } else { Err(StepError::Attitude { time, angle, step }) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed form: the surplus over the inertia times the time.
    #[test]
    fn momentum_from_nowhere_adds_up_to_an_angle_and_what_loads_put_in_does_not() {
        let mut account = AttitudeAccount::default();
        // A moment of inertia of 2: a surplus of 0.1 turns by 0.05 in each unit of time.
        let spin_of = |momentum: &Vector3<f64>| momentum / 2.0;
        let start = Vector3::new(0.0, 3.0, -1.0);
        for time in 0..100 {
            account.check(f64::from(time), start, spin_of, 1.0).unwrap();
        }
        let more = start + Vector3::new(0.0, 0.0, 0.1);
        for time in 100..119 {
            account.check(f64::from(time), more, spin_of, 1.0).unwrap();
        }
        let error = account.check(121.0, more, spin_of, 1.0).unwrap_err();
        let StepError::Attitude { time: 121.0, angle, step: 1.0 } = error else { panic!("{error}") };
        assert!((angle - 1.1).abs() < 1e-12, "{angle}");
    }

    #[test]
    fn turns_to_and_fro_cancel() {
        let mut account = AttitudeAccount::default();
        account.check(0.0, Vector3::zeros(), |h| *h, 1.0).unwrap();
        for time in 1..1000 {
            let swing = if time % 2 == 0 { 0.5 } else { -0.5 };
            account.check(f64::from(time), Vector3::x() * swing, |h| *h, 1.0).unwrap();
        }
    }

    #[test]
    fn a_momentum_that_is_no_number_is_found() {
        let mut account = AttitudeAccount::default();
        account.check(0.0, Vector3::zeros(), |h| *h, 1.0).unwrap();
        assert!(account.check(1.0, Vector3::new(f64::NAN, 0.0, 0.0), |h| *h, 1.0).is_err());
    }
}
