//! Quantities that a step sums up: works, impulses, dissipation, momenta.

use serde::{Deserialize, Serialize};

use crate::conservative::{Slow, part};
use crate::simulation::checkpoint::{CheckpointError, expect, finite};
use crate::system::collocation::STAGES;
use crate::system::radau::{JointWork, SystemMotion};

/// Rates at one stage of a step of what the step sums up.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(in crate::system) struct StageRates {
    /// Rates of each body, of which those from the work on count.
    bodies: Vec<Slow>,
    /// Powers at the joints.
    joints: Vec<JointWork>,
    /// Power of the force elements.
    elements: f64,
    /// y', with the forces of the joints.
    pub(super) y: Vec<f64>,
}

impl StageRates {
    /// Room for bodies with these numbers of modes, and so many joints.
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

impl SystemMotion {
    /// Finds the rates at the stages of a step. What joints and elements do to a body counts as its loads do, so that its balances
    /// close.
    pub(super) fn find_stage_rates(&mut self) {
        let Self { stages, multipliers, system, stage_rates, .. } = self;
        for ((stage, lambda), rates) in stages.iter_mut().zip(&*multipliers).zip(stage_rates) {
            stage.find_y_rates(system, lambda, &mut rates.y);
            let mut of_rows = lambda.iter().zip(&stage.constraints.own_rates);
            for (joint, powers) in system.connections.joints.iter().zip(&mut rates.joints) {
                let drive = of_rows.by_ref().take(joint.row_count()).map(|(lambda, rate)| -lambda * rate).sum();
                *powers = JointWork { drive, ..JointWork::default() };
            }
            for ((joint, ..), power) in system.connections.joint_forces().zip(&stage.joint_powers) {
                let powers = &mut rates.joints[joint];
                powers.drive += power.motor;
                powers.spring += power.spring;
                powers.loss -= power.friction;
            }
            rates.elements = stage.element_power;
            stage.find_joint_forces(lambda);
            for (b, rates) in rates.bodies.iter_mut().enumerate() {
                rates.copy_from_slice(stage.evaluations[b].rates.slow());
                stage.add_joint_exchange(system, b, rates);
            }
        }
    }

    /// Adds their integrals, by the weights of the stages.
    pub(super) fn add_exchange(&mut self, weights: [f64; STAGES]) {
        let Self { stage_rates, bodies, system, joint_works, element_work, .. } = self;
        for (rates, weight) in stage_rates.iter().zip(weights) {
            for (work, power) in joint_works.iter_mut().zip(&rates.joints) {
                work.drive += weight * power.drive;
                work.spring += weight * power.spring;
                work.loss += weight * power.loss;
            }
            *element_work += weight * rates.elements;
            for ((body, state), rates) in system.bodies.iter().zip(&mut *bodies).zip(&rates.bodies) {
                let mut list = body.list_mut(state);
                let mut slow = *list.slow();
                for k in part::WORK..slow.len() {
                    slow[k] += weight * rates[k];
                }
                list.set_slow(&slow);
            }
        }
    }
}
