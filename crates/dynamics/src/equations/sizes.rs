//! Sizes of a motion and of its error: their ratio is kept within the tolerance.

use serde::{Deserialize, Serialize};

use crate::simulation::checkpoint::{CheckpointError, finite};

/// Squares of the sizes of a motion, or of the difference of two states.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Sizes {
    /// Energy, that of the origin's motion left out where it is a motion's.
    pub energy: f64,
    /// Σ q², which is ∫ ρ |u|² dV.
    pub displacement: f64,
    /// ∫ ρ |a|² dV of the rigid motion and of the modes.
    pub acceleration: f64,
}

/// Part of the motion, as a ratio of amplitudes, below which a vibration is taken as rounding.
const STILL: f64 = 1e-6;

impl Sizes {
    /// The larger of each.
    pub(crate) fn max(self, other: Self) -> Self {
        Self {
            energy: self.energy.max(other.energy),
            displacement: self.displacement.max(other.displacement),
            acceleration: self.acceleration.max(other.acceleration),
        }
    }

    /// Refuses numbers that are not finite.
    pub(crate) fn check(&self) -> Result<(), CheckpointError> {
        finite("the size of the motion", [&self.energy, &self.displacement, &self.acceleration])
    }

    /// The largest of the three beside those of a motion of a body with this lowest ω_k.
    pub(crate) fn relative_to(self, motion: Self, lowest: f64) -> f64 {
        // What vibrates with less is rounding.
        let still = STILL * STILL * motion.energy;
        let square = lowest * lowest;
        let pairs = [
            (self.energy, motion.energy),
            (self.displacement, motion.displacement.max(still / square)),
            (self.acceleration, motion.acceleration.max(still * square)),
        ];
        let ratios = pairs.map(|(error, whole)| if error == 0.0 { 0.0 } else { (error / whole).sqrt() });
        // A NaN stays one.
        ratios.into_iter().fold(0.0, |most, ratio| if ratio <= most { most } else { ratio })
    }
}
