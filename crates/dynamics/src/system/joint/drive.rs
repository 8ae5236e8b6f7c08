//! Drives and motors of joints: an amplitude over time.

use crate::history::History;

/// An angle (rad), a distance, a force or a moment over time: the amplitude times the history.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub struct JointDrive {
    /// Value where the history is 1.
    pub amplitude: f64,
    /// Factor over time.
    pub history: History,
}

impl JointDrive {
    /// Its value and its rate at a time, by the branch that holds at `branch_time`.
    pub(crate) fn at(&self, [time, branch_time]: [f64; 2]) -> [f64; 2] {
        [self.history.at(time, branch_time), self.history.rate(time, branch_time)].map(|of| self.amplitude * of)
    }
}
