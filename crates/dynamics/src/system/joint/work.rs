//! Works at a joint, or of a spring or a bushing.

use serde::{Deserialize, Serialize};

/// Works at a joint since the beginning, or of a force element.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct JointWork {
    /// Work of its drive and its motors; all of that of an element whose energy is not known.
    pub drive: f64,
    /// Work of its springs, stops and preload; negative while they hold energy.
    pub spring: f64,
    /// Energy that friction and dampers have taken out.
    pub loss: f64,
}

impl JointWork {
    /// Adds another times a factor.
    pub(crate) fn add(&mut self, factor: f64, other: &Self) {
        self.drive += factor * other.drive;
        self.spring += factor * other.spring;
        self.loss += factor * other.loss;
    }

    /// Work on the bodies.
    pub(crate) fn given(&self) -> f64 {
        self.drive + self.spring - self.loss
    }

    /// Its numbers.
    pub(crate) fn list(&self) -> [f64; 3] {
        [self.drive, self.spring, self.loss]
    }
}
