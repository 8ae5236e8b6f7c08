//! The work of laws in a step as an error of the step, and in its balances; the first kink of a law.

use crate::conservative::part;
use crate::system::collocation::STAGES;
use crate::system::joint::work::JointWork;
use crate::system::marker::Marker;
use crate::system::radau::SystemMotion;
use crate::system::radau::law_work::{LawWork, Path};

/// The least part of a run for which the error of a step by the energy of laws counts.
const LEAST_PART: f64 = 1e-3;

impl SystemMotion {
    /// The path of a step by collocation whose stages are known, or of an explicit one, and room for the works of laws along it.
    fn path(&mut self, h: f64) -> (Path<'_>, &mut LawWork) {
        let Self { system, start, scheme, stages, last, law_work, .. } = self;
        let increments: [&[f64]; STAGES] = if scheme.is_explicit {
            last.each_ref().map(|[x, _]| &x[..])
        } else {
            stages.each_ref().map(|of| &of.x[..])
        };
        (Path { system, start, scheme, increments, h }, law_work)
    }

    /// Energy that the step makes or loses at laws over twice the largest so far. The works of the laws are then known.
    pub(super) fn energy_error(&mut self, h: f64) -> f64 {
        let (path, works) = self.path(h);
        works.find(&path, 1.0);
        let made = works.made(&path);
        if made == 0.0 { 0.0 } else { 0.5 * made / self.largest_energy }
    }

    /// The same over the part of the run that the step is.
    pub(super) fn energy_error_in_run(&mut self, h: f64) -> f64 {
        self.energy_error(h) / (h / self.span).max(LEAST_PART)
    }

    /// Length of the step to the first kink of a law within it; none without.
    pub(super) fn length_to_kink(&mut self, h: f64) -> Option<f64> {
        let (path, works) = self.path(h);
        works.first_kink(&path).map(|part| part * h)
    }

    /// Replaces the works of laws that the stages have summed up by those of the finer rule. The difference, which the step has made or
    /// lost, is counted as work on the bodies that they act on, in equal parts, so that balances tell.
    pub(super) fn settle_laws(&mut self, weights: [f64; STAGES]) {
        let Self { system, law_work, stage_rates, joint_works, element_works, bodies, .. } = self;
        if !law_work.has_work {
            return;
        }
        let mut settle = |work: &mut JointWork, fine: &JointWork, staged: &JointWork, markers: &[Marker]| {
            let mut missing = *fine;
            missing.add(-1.0, staged);
            work.add(1.0, &missing);
            let held = markers.iter().filter_map(|marker| marker.body());
            let share = missing.given() / held.clone().count().max(1) as f64;
            if share == 0.0 {
                return;
            }
            for b in held {
                let mut list = system.bodies[b].list_mut(&mut bodies[b]);
                let mut slow = *list.slow();
                slow[part::WORK] += share;
                list.set_slow(&slow);
            }
        };
        let connections = &system.connections;
        for (number, (joint, fine)) in connections.joints.iter().zip(&law_work.joints).enumerate() {
            let mut staged = JointWork::default();
            stage_rates.iter().zip(weights).for_each(|(rates, weight)| staged.add(weight, &rates.laws[number]));
            settle(&mut joint_works[number], fine, &staged, &joint.markers);
        }
        for (number, (element, fine)) in connections.elements.iter().zip(&law_work.elements).enumerate() {
            let mut staged = JointWork::default();
            stage_rates.iter().zip(weights).for_each(|(rates, weight)| staged.add(weight, &rates.elements[number]));
            staged.spring = 0.0;
            settle(&mut element_works[number], fine, &staged, element.markers());
        }
    }
}
