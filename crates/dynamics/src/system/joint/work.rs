//! Works at a joint.

use serde::{Deserialize, Serialize};

/// Works at a joint since the beginning.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct JointWork {
    /// What its drive and its motors have put in.
    pub drive: f64,
    /// What its springs, stops and preload have given back; negative for what they hold.
    pub spring: f64,
    /// What friction and dampers have taken out.
    pub loss: f64,
}
