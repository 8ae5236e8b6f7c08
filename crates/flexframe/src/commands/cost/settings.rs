//! Settings of a price list.

use std::time::Duration;

use super::reference::Budget;

/// Settings of a price list.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CostSettings {
    /// Limit of the time of a run: it is stopped when this is used up, and the ladders end before runs that would take
    /// longer. All
    /// runs of the reference together may take twenty times as long.
    pub patience: Duration,
    /// The ladders end before runs with more steps than this; the reference may have four times as many.
    pub max_steps: u64,
    /// Each run is repeated until it has been timed for so long.
    pub timed_for: Duration,
    /// An error for which the cheapest setting is wanted.
    pub target: Option<f64>,
}

impl Default for CostSettings {
    fn default() -> Self {
        Self::with_patience(Duration::from_secs(1))
    }
}

impl CostSettings {
    /// Each run timed for a tenth of the patience.
    pub fn with_patience(patience: Duration) -> Self {
        Self { patience, max_steps: 1_000_000, timed_for: patience / 10, target: None }
    }

    /// Time and steps that a reference may take.
    pub(super) fn budget(&self, patience: u32) -> Budget {
        Budget { time: self.patience.saturating_mul(patience), steps: 4 * self.max_steps }
    }
}
