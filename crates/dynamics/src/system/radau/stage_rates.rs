//! Rates at one stage of a step of what the step sums up.

use serde::{Deserialize, Serialize};

use crate::conservative::Slow;
use crate::simulation::checkpoint::{CheckpointError, expect, finite};
use crate::system::joint::work::JointWork;

/// Works, impulses, dissipation and momenta at one stage, each by its rate.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(in crate::system) struct StageRates {
    /// Rates of each body, of which those from the work on count.
    pub(super) bodies: Vec<Slow>,
    /// Powers at the joints.
    pub(super) joints: Vec<JointWork>,
    /// Power of the force elements.
    pub(super) elements: f64,
    /// y', with the forces of the joints.
    pub(super) y: Vec<f64>,
}

impl StageRates {
    /// Room for bodies with these numbers of modes, and for the rows of joints.
    pub(super) fn new(flexible: &[usize], joints: usize) -> Self {
        Self {
            bodies: vec![[0.0; 20]; flexible.len()],
            joints: vec![JointWork::default(); joints],
            elements: 0.0,
            y: vec![0.0; flexible.iter().map(|modes| 6 + modes).sum()],
        }
    }

    /// Takes over other rates, without allocating.
    pub(super) fn copy_from(&mut self, other: &Self) {
        self.bodies.copy_from_slice(&other.bodies);
        self.joints.copy_from_slice(&other.joints);
        self.y.copy_from_slice(&other.y);
        self.elements = other.elements;
    }

    /// Refuses those of another system, and numbers that are not finite.
    pub(in crate::system) fn check(&self, own: &Self) -> Result<(), CheckpointError> {
        let lengths = |of: &Self| [of.bodies.len(), of.joints.len(), of.y.len()];
        expect("the rates of the last step", lengths(self) == lengths(own))?;
        let of_joints = self.joints.iter().flat_map(|JointWork { drive, spring, loss }| [drive, spring, loss]);
        let numbers = self.bodies.iter().flatten().chain(of_joints).chain(&self.y).chain([&self.elements]);
        finite("the rates of the last step", numbers)
    }
}
