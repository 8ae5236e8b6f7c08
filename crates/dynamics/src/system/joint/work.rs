//! Works at a joint.

use serde::{Deserialize, Serialize};

/// Works at a joint since the beginning.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct JointWork {
    /// Work of its drive and its motors.
    pub drive: f64,
    /// Work of its springs, stops and preload; negative while they hold energy.
    pub spring: f64,
    /// Energy that friction and dampers have taken out.
    pub loss: f64,
}
