//! A load times a factor from outside.

use keys::Key;

use super::{Applied, Kinematics, Load, Pattern, SharedLoad};
use crate::error::SetupError;
use crate::history::History;
use crate::load::signal::Signal;

/// A load times a factor that a program sets between steps, beside its own history.
#[derive(Debug, Clone)]
pub struct ScaledLoad {
    /// The load where the factor is 1.
    pub load: SharedLoad,
    /// The factor.
    pub factor: Signal,
}

impl Load for ScaledLoad {
    fn apply(&self, motion: &Kinematics, applied: &mut Applied) {
        let factor = self.factor.at(motion.time);
        if factor == 0.0 {
            return;
        }
        let weight = applied.weight;
        applied.weight *= factor;
        self.load.apply(motion, applied);
        applied.weight = weight;
    }

    fn key(&self, key: Key) -> Key {
        // Who sets the factor keeps it.
        self.load.key(key.of("scaled load", 1))
    }

    fn discontinuities(&self) -> Vec<f64> {
        self.load.discontinuities()
    }

    fn longest_step(&self, branch_time: f64) -> f64 {
        self.load.longest_step(branch_time)
    }

    fn history(&self) -> Option<&History> {
        self.load.history()
    }

    fn pattern(&self) -> Option<Pattern> {
        self.load.pattern()
    }

    fn matrix_entries(&self) -> usize {
        self.load.matrix_entries()
    }

    fn check(&self, flexible: usize) -> Result<(), SetupError> {
        self.load.check(flexible)
    }
}
