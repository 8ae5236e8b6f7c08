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

/// Work of a spring in a step over its energy, and change of the energy over it, below which it rests.
const AT_REST: f64 = 1e-12;
const UNMOVED: f64 = 1e-9;

impl SystemMotion {
    /// Keeps the energy of the springs at the start of a step.
    pub(super) fn keep_spring_energies(&mut self) {
        let Self { system, start, first, room, .. } = self;
        let joints = system.connections.joints.iter().zip(&start.joints);
        let of_elements = room.spring_energies.iter_mut().skip(joints.len());
        if of_elements.len() > 0 {
            first.x.fill(0.0);
            first.place(system, start);
            of_elements
                .enumerate()
                .for_each(|(number, energy)| *energy = first.element_energy(system, number, start.time));
        }
        for (energy, (joint, coordinates)) in room.spring_energies.iter_mut().zip(joints) {
            *energy = energy_of(joint, coordinates);
        }
    }

    /// Replaces the work of springs that the stages have summed up since [`Self::keep_spring_energies`] by the change of their energy. The
    /// difference, which the step has made or lost, is counted as work on the bodies that they hold, in equal parts, so that balances tell.
    pub(super) fn settle_springs(&mut self, weights: [f64; STAGES]) {
        let Self { system, start, room, stage_rates, joint_works, element_works, bodies, time, .. } = self;
        let [.., last] = &mut self.stages;
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
                    let after = last.element_energy(system, element, *time);
                    (after, &system.connections.element_markers[element][..], &mut element_works[element])
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
