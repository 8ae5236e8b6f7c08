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

/// Energies of a run that the balances of a body are counted over.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunEnergies {
    /// Energy that has come and gone: the sum of |work| + |dissipation| of all steps of a body that moves alone, whose loads the stages sum up,
    /// or the energy that a bent rest which nothing holds sets free, if that is more; the largest |work| + |dissipation| since the beginning
    /// of one in joints, or the largest energy of the motion, if that is more. Not their sum over the steps: what a spring gives and takes in
    /// each period would hide what is lost in all of them.
    pub exchanged: f64,
    /// Energy below which a body in joints rests; zero of one alone.
    pub at_rest: f64,
    /// Largest energy of all bodies in joints together for which works and dissipation do not account.
    pub open_together: Option<f64>,
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
