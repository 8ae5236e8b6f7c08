//! Quantities that a step sums up: works, impulses, dissipation, momenta.

use crate::conservative::part;
use crate::system::collocation::STAGES;
use crate::system::joint::work::JointWork;
use crate::system::radau::SystemMotion;

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
