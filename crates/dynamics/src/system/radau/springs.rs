//! Energy of springs and stops, which is known by where the bodies are.
//!
//! The stages of a step sum up the work of a spring; its energy is a function of the place. Where a step goes into a stop, leaves it, or is
//! long for a spring, the two differ: by energy that the step makes or loses. Eqs. (J21) of `docs/method/systems.md`.

use crate::conservative::part;
use crate::system::collocation::STAGES;
use crate::system::joint::Joint;
use crate::system::joint::coordinate::{Coordinate, JointCoordinates};
use crate::system::joint::force::JointForce;
use crate::system::radau::SystemMotion;

/// Energy that a step makes or loses at a stop over the largest so far, for which it counts as an error of one: a bounce takes some ten
/// steps, and what it makes or loses is not forgotten.
const STOP_ERROR: f64 = 0.1;
/// Rounding of the energy of a spring over the energy.
const ROUNDING: f64 = 1e-13;
/// Work of a spring in a step over its energy, and change of the energy over it, below which it rests.
const AT_REST: f64 = 1e-12;
const UNMOVED: f64 = 1e-9;

impl SystemMotion {
    /// Error of a step of length `h` by the energy that joints make or lose in it at their stops. `power` has that of the springs of a joint at
    /// a stage, by the numbers of the joint and of its first force; `after` the coordinate of a force at the end of the step.
    pub(super) fn stop_error(
        &self,
        h: f64,
        power: impl Fn(usize, usize, usize) -> f64,
        after: impl Fn(usize) -> f64,
    ) -> f64 {
        let (mut made, mut first) = (0.0, 0);
        for (number, joint) in self.system.connections.joints.iter().enumerate() {
            let own = first..first + joint.forces().count();
            first = own.end;
            let forces = || joint.forces().map(|(_, force)| force).zip(own.clone());
            if forces().all(|(force, _)| force.stops.is_none()) {
                continue;
            }
            let before = |force: usize| self.first.constraints.coordinates[force];
            let is_touched = |(force, at): (&JointForce, usize)| {
                let within = self.stages.iter().map(|stage| stage.constraints.coordinates[at]);
                within.chain([before(at), after(at)]).any(|x| force.is_at_stop(x))
            };
            if !forces().any(is_touched) {
                continue;
            }
            let energy = |at: &dyn Fn(usize) -> f64| forces().map(|(force, own)| force.energy(at(own))).sum::<f64>();
            let [start, end] = [energy(&before), energy(&after)];
            let work: f64 =
                (0..STAGES).map(|stage| self.scheme.weights[stage] * h * power(stage, number, own.start)).sum();
            let missing = (end - start + work).abs();
            if missing > ROUNDING * (start.abs() + end.abs()) || missing.is_nan() {
                made += missing;
            }
        }
        if made == 0.0 { 0.0 } else { made / (STOP_ERROR * self.largest_energy) }
    }

    /// The same of a step by collocation, whose stages are known.
    pub(super) fn stop_error_of_stages(&self, h: f64) -> f64 {
        let coordinate = |stage: usize, force: usize| self.stages[stage].constraints.coordinates[force];
        let after = |force: usize| {
            let before = self.first.constraints.coordinates[force];
            let to_end = |factors: [f64; STAGES]| {
                (0..STAGES).map(|stage| factors[stage] * (coordinate(stage, force) - before)).sum::<f64>() + before
            };
            self.scheme.at_end.map_or_else(|| coordinate(STAGES - 1, force), to_end)
        };
        let power = |stage: usize, joint: usize, first: usize| {
            let count = self.system.connections.joints[joint].forces().count();
            self.stages[stage].joint_powers[first..first + count].iter().map(|power| power.spring).sum()
        };
        self.stop_error(h, power, after)
    }

    /// Keeps the energy of the springs at the start of a step.
    pub(super) fn keep_spring_energies(&mut self) {
        let Self { system, start, first, room, .. } = self;
        let joints = system.connections.joints.iter().zip(&start.joints);
        let of_elements = room.spring_energies.iter_mut().skip(joints.len());
        if of_elements.len() > 0 {
            first.x.fill(0.0);
            first.place(system, start);
            of_elements.enumerate().for_each(|(number, energy)| *energy = first.element_energy(system, number));
        }
        for (energy, (joint, coordinates)) in room.spring_energies.iter_mut().zip(joints) {
            *energy = energy_of(joint, coordinates);
        }
    }

    /// Replaces the work of springs that the stages have summed up since [`Self::keep_spring_energies`] by the change of their energy. The
    /// difference, which the step has made or lost, is counted as work on the bodies that they hold, in equal parts, so that balances tell.
    pub(super) fn settle_springs(&mut self, weights: [f64; STAGES]) {
        let Self { system, start, room, stage_rates, joint_works, element_works, bodies, stages: [.., last], .. } =
            self;
        let joints = joint_works.len();
        for (number, before) in room.spring_energies.iter().enumerate() {
            let works = stage_rates.iter().zip(weights).map(|(rates, weight)| weight * rates.spring(number));
            let summed: f64 = works.clone().sum();
            let (after, markers, work) = match number.checked_sub(joints) {
                None => {
                    let joint = &system.connections.joints[number];
                    (energy_of(joint, &start.joints[number]), &joint.markers[..], &mut joint_works[number])
                }
                Some(element) => {
                    let after = last.element_energy(system, element);
                    (after, system.connections.elements[element].markers(), &mut element_works[element])
                }
            };
            let missing = before - after - summed;
            // What rests on its spring has less energy than what Newton's method leaves of the spring's.
            let done: f64 = works.map(f64::abs).sum();
            let [rests, stays] = [AT_REST, UNMOVED].map(|part| part * (before.abs() + after.abs()));
            if missing == 0.0 || done <= rests && missing.abs() <= stays {
                continue;
            }
            work.spring += missing;
            let held = markers.iter().filter_map(|marker| marker.body());
            let share = missing / held.clone().count().max(1) as f64;
            for b in held {
                let mut list = system.bodies[b].list_mut(&mut bodies[b]);
                let mut slow = *list.slow();
                slow[part::WORK] += share;
                list.set_slow(&slow);
            }
        }
    }
}

/// Energy of the springs of a joint.
fn energy_of(joint: &Joint, coordinates: &JointCoordinates) -> f64 {
    let of_force = |(coordinate, force): (Coordinate, &JointForce)| {
        let [x, _] = coordinates.along(coordinate);
        force.energy(x)
    };
    joint.forces().map(of_force).sum()
}
