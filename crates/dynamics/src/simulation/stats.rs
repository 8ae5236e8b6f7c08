//! Cost of a run, of a body alone or of a system.

use serde::{Deserialize, Serialize};

use crate::simulation::checkpoint::{CheckpointError, counts, expect, fixed_room};
use crate::tolerance::StatedError;

/// Cost of a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Stats {
    /// Steps taken.
    #[serde(with = "fixed_room")]
    pub accepted: u64,
    /// Steps tried in vain. Of a body alone under step control: two for each try.
    #[serde(with = "fixed_room")]
    pub rejected: u64,
    /// Evaluations of the rates.
    #[serde(skip)] // the motion counts them
    pub evaluations: u64,
    /// Length of the shortest step taken; infinite before the first.
    pub shortest: f64,
    /// Length of the longest step taken.
    pub longest: f64,
    /// Error of the steps by their estimates; none of fixed steps.
    #[serde(skip)] // the step control sums it up
    pub error: Option<StatedError>,
}

impl Stats {
    /// Before the first step.
    pub(crate) const NONE: Self =
        Self { accepted: 0, rejected: 0, evaluations: 0, shortest: f64::INFINITY, longest: 0.0, error: None };

    /// Counts steps of a length that were taken.
    pub(crate) fn take(&mut self, steps: u64, length: f64) {
        self.accepted += steps;
        self.shortest = self.shortest.min(length);
        self.longest = self.longest.max(length);
    }

    /// Refuses what no run leaves.
    pub(crate) fn check(&self) -> Result<(), CheckpointError> {
        counts(&[self.accepted, self.rejected])?;
        expect("the length of a step", self.shortest > 0.0 && self.longest >= 0.0)
    }
}
