//! Rows and stops that are still to be told.

use serde::{Deserialize, Serialize};

use crate::simulation::checkpoint::{CheckpointError, counts, equal_room, expect, fixed_room};

/// Rows and stops that have come with the last step.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(crate) struct Due {
    /// The time of the row within the last step that has been reached.
    #[serde(with = "equal_room")]
    pub within: Option<f64>,
    /// Number of the next row at an interval.
    #[serde(with = "fixed_room")]
    pub rows: u64,
    /// True if the stop has been reached, and is still to be told.
    pub stop: bool,
    /// The same of a row after a number of steps.
    pub row: bool,
}

impl Due {
    /// Before the first step.
    pub(crate) const NOTHING: Self = Self { within: None, rows: 1, stop: false, row: false };

    /// Refuses what no run leaves.
    pub(crate) fn check(&self) -> Result<(), CheckpointError> {
        counts(&[self.rows])?;
        expect("the number of rows", self.rows > 0)
    }
}
