//! Stops that a step goes into, as the reason why it could not be done.

use std::f64::consts::PI;

use crate::system::radau::SystemMotion;

impl SystemMotion {
    /// Joints that are at a stop, or reach one within a time, and how long the shortest touch of them lasts: half a period of the stop with
    /// the bodies as if no other joint held them, which is at most the true one. None where no joint does.
    pub(super) fn stops_within(&mut self, h: f64) -> Option<(Vec<String>, f64)> {
        self.begin();
        self.evaluate_first(self.time).ok()?;
        let Self { first, system, start, .. } = self;
        let (mut names, mut shortest) = (Vec::new(), f64::INFINITY);
        for (number, (joint, coordinate, force)) in system.connections.joint_forces().enumerate() {
            let [x, rate] = start.joints[joint].along(coordinate);
            let Some(stops) = force.stops.filter(|_| [x, x + h * rate].iter().any(|x| force.is_at_stop(*x))) else {
                continue;
            };
            let ends = &first.constraints.compliant_ends()[number];
            let mut moved = vec![0.0; system.coordinates()];
            ends.iter().for_each(|end| end.add_force(1.0, &mut moved));
            for (b, inertia) in first.inertia.iter().enumerate() {
                inertia.solve(&mut moved[system.first[b]..system.first[b + 1]]);
            }
            let mut mobility = 0.0;
            ends.iter().for_each(|end| end.add_rate(1.0, &moved, &mut mobility));
            shortest = shortest.min(PI / (stops.stiffness * mobility).sqrt());
            names.push(system.connections.joints[joint].name.clone());
        }
        (!names.is_empty() && shortest.is_finite()).then_some((names, shortest))
    }
}
