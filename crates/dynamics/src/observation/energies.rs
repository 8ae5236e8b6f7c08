//! The energies of a state.

use serde::{Deserialize, Serialize};

use crate::simulation::checkpoint::{CheckpointError, finite};

/// The energy of a state, and what has been done to it since the start.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Energies {
    /// Time.
    pub time: f64,
    /// Energy without that of the motion of the origin.
    pub internal: f64,
    /// Energy of the motion of the origin.
    pub translation: f64,
    /// Work of the loads.
    pub work: f64,
    /// Energy that damping has taken.
    pub dissipation: f64,
}

impl Energies {
    /// All its numbers.
    fn numbers(&self) -> [&f64; 5] {
        [&self.time, &self.internal, &self.translation, &self.work, &self.dissipation]
    }

    /// Refuses numbers that are not finite.
    pub(crate) fn check(&self) -> Result<(), CheckpointError> {
        finite("an energy", self.numbers())
    }
}
