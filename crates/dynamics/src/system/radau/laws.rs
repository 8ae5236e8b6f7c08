//! The work of laws in a step as an error of the step, and in its balances; the first kink of a law.

use crate::conservative::part;
use crate::error::RateError;
use crate::system::collocation::STAGES;
use crate::system::joint::work::JointWork;
use crate::system::marker::Marker;
use crate::system::radau::SystemMotion;
use crate::system::radau::law_work::{LawWork, Path};

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

    /// The energy that there has been or that has come and gone: the largest of the motion, or all works at joints and elements.
    pub(in crate::system) fn energy_scale(&self) -> f64 {
        let works = self.joint_works.iter().chain(&self.element_works).flat_map(JointWork::list);
        self.largest_moving.max(works.map(f64::abs).sum())
    }

    /// Energy that the step makes or loses at laws over twice the largest so far, from rest that which the step makes. The works of the laws are
    /// then known.
    pub(super) fn energy_error(&mut self, h: f64) -> f64 {
        let (path, works) = self.path(h);
        works.find(&path, 1.0);
        let made = works.made(&path);
        if made == 0.0 {
            return 0.0;
        }
        let exchanged = works.exchanged();
        // The times of stages round: what ramps up within a very short step is off by as much of it.
        let rounding = f64::EPSILON * self.time.abs() / h * exchanged;
        let Self { stages: [.., last], system, .. } = self;
        let [moving, _] = last.energies(system, h);
        0.5 * (made - rounding).max(0.0) / self.energy_scale().max(moving).max(exchanged)
    }

    /// Length of the step to the first kink of a law within it; none without.
    pub(super) fn length_to_kink(&mut self, h: f64) -> Result<Option<f64>, RateError> {
        let (path, works) = self.path(h);
        Ok(works.first_kink(&path)?.map(|part| part * h))
    }

    /// Keeps the coordinates of forces of joints where a step begins.
    pub(super) fn keep_coordinates(&mut self) {
        let Self { system, start, room, .. } = self;
        for ((joint, coordinate, _), kept) in system.connections.joint_forces().zip(&mut room.coordinates) {
            *kept = start.joints[joint].along(coordinate);
        }
    }

    /// Counts the time since [`Self::keep_coordinates`], and the path, for friction that holds then and now.
    pub(super) fn count_held(&mut self, elapsed: f64) {
        let Self { system, start, room, held, .. } = self;
        let forces = system.connections.joint_forces().zip(&room.coordinates).zip(held);
        for (((joint, coordinate, force), [from, rate_before]), [time, path]) in forces {
            let [to, rate] = start.joints[joint].along(coordinate);
            if force.holds(*rate_before) && force.holds(rate) {
                *time += elapsed;
                *path += (to - from).abs();
            }
        }
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
        for (number, (markers, fine)) in connections.element_markers.iter().zip(&law_work.elements).enumerate() {
            let mut staged = JointWork::default();
            stage_rates.iter().zip(weights).for_each(|(rates, weight)| staged.add(weight, &rates.elements[number]));
            staged.spring = 0.0;
            settle(&mut element_works[number], fine, &staged, markers);
        }
    }
}
