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
    /// Powers of the force elements.
    pub(super) elements: Vec<JointWork>,
    /// Powers of the springs of each joint whose energy is known: without characteristics.
    pub(super) springs: Vec<f64>,
    /// Powers at each joint of the forces along its coordinates whose energy no formula tells.
    pub(super) laws: Vec<JointWork>,
    /// y', with the forces of the joints.
    pub(super) y: Vec<f64>,
}

impl StageRates {
    /// Room for bodies with these numbers of modes, for the rows of joints, and for elements.
    pub(super) fn new(flexible: &[usize], [joints, elements]: [usize; 2]) -> Self {
        Self {
            bodies: vec![[0.0; 20]; flexible.len()],
            joints: vec![JointWork::default(); joints],
            elements: vec![JointWork::default(); elements],
            springs: vec![0.0; joints],
            laws: vec![JointWork::default(); joints],
            y: vec![0.0; flexible.iter().map(|modes| 6 + modes).sum()],
        }
    }

    /// Takes over other rates, without allocating.
    pub(super) fn copy_from(&mut self, other: &Self) {
        self.bodies.copy_from_slice(&other.bodies);
        self.joints.copy_from_slice(&other.joints);
        self.y.copy_from_slice(&other.y);
        self.elements.copy_from_slice(&other.elements);
        self.springs.copy_from_slice(&other.springs);
        self.laws.copy_from_slice(&other.laws);
    }

    /// Power of the springs whose energy is known: of each joint, then of each element.
    pub(super) fn spring(&self, number: usize) -> f64 {
        match number.checked_sub(self.joints.len()) {
            None => self.springs[number],
            Some(element) => self.elements[element].spring,
        }
    }

    /// Refuses those of another system, and numbers that are not finite.
    pub(in crate::system) fn check(&self, own: &Self) -> Result<(), CheckpointError> {
        let lengths = |of: &Self| {
            let works = [&of.joints, &of.elements, &of.laws].map(Vec::len);
            (works, [of.bodies.len(), of.springs.len(), of.y.len()])
        };
        expect("the rates of the last step", lengths(self) == lengths(own))?;
        let works = self.joints.iter().chain(&self.elements).chain(&self.laws).flat_map(JointWork::list);
        let numbers = self.bodies.iter().flatten().chain(&self.y).chain(&self.springs).copied().chain(works);
        finite("the rates of the last step", numbers)
    }
}
