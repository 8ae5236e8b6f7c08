//! Quantities that a step sums up: works, impulses, dissipation, momenta.

use crate::conservative::part;
use crate::system::collocation::STAGES;
use crate::system::description::System;
use crate::system::joint::work::JointWork;
use crate::system::radau::SystemMotion;
use crate::system::radau::stage_rates::StageRates;
use crate::system::stage::Stage;

impl SystemMotion {
    /// Finds the rates at the stages of a step.
    pub(super) fn find_stage_rates(&mut self) {
        let Self { stages, multipliers, system, stage_rates, .. } = self;
        for ((stage, lambda), rates) in stages.iter_mut().zip(&*multipliers).zip(stage_rates) {
            rates.find(system, stage, lambda);
        }
    }

    /// Adds their integrals, by the weights of the stages.
    pub(super) fn add_exchange(&mut self, weights: [f64; STAGES]) {
        let Self { stage_rates, bodies, system, joint_works, element_works, .. } = self;
        for (rates, weight) in stage_rates.iter().zip(weights) {
            joint_works.iter_mut().zip(&rates.joints).for_each(|(work, power)| work.add(weight, power));
            element_works.iter_mut().zip(&rates.elements).for_each(|(work, power)| work.add(weight, power));
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

impl StageRates {
    /// Finds the rates at a stage with these multipliers. What joints and elements do to a body counts as its loads do, so that its
    /// balances close.
    pub(super) fn find(&mut self, system: &System, stage: &mut Stage, lambda: &[f64]) {
        stage.find_y_rates(system, lambda, &mut self.y);
        let mut of_rows = lambda.iter().zip(&stage.constraints.own_rates);
        for (joint, powers) in system.connections.joints.iter().zip(&mut self.joints) {
            let drive = of_rows.by_ref().take(joint.row_count()).map(|(lambda, rate)| -lambda * rate).sum();
            *powers = JointWork { drive, ..JointWork::default() };
        }
        self.springs.fill(0.0);
        self.laws.fill(JointWork::default());
        for ((joint, ..), power) in system.connections.joint_forces().zip(&stage.joint_powers) {
            let of_laws = power.of_laws();
            self.laws[joint].add(1.0, &of_laws);
            self.joints[joint].add(1.0, &of_laws);
            self.joints[joint].spring += power.spring;
            self.springs[joint] += power.spring;
        }
        self.elements.copy_from_slice(&stage.element_powers);
        stage.find_joint_forces(lambda);
        for (b, rates) in self.bodies.iter_mut().enumerate() {
            rates.copy_from_slice(stage.evaluations[b].rates.slow());
            stage.add_joint_exchange(system, b, rates);
        }
    }

    /// Takes the mean of its rates and others.
    pub(super) fn average(&mut self, other: &Self) {
        let mean = |own: &mut f64, other: &f64| *own = 0.5 * (*own + other);
        let of_bodies = self.bodies.iter_mut().flatten().zip(other.bodies.iter().flatten());
        of_bodies.for_each(|(own, other)| mean(own, other));
        self.y.iter_mut().zip(&other.y).for_each(|(own, other)| mean(own, other));
        self.springs.iter_mut().zip(&other.springs).for_each(|(own, other)| mean(own, other));
        let joints = self.joints.iter_mut().zip(&other.joints).chain(self.laws.iter_mut().zip(&other.laws));
        for (own, other) in joints.chain(self.elements.iter_mut().zip(&other.elements)) {
            mean(&mut own.drive, &other.drive);
            mean(&mut own.spring, &other.spring);
            mean(&mut own.loss, &other.loss);
        }
    }
}
