//! Joints, springs and bushings of a motion, as they are seen in a row of results.

use crate::system::joint::coordinate::Coordinate;
use crate::system::joint::observation::JointObservation;
use crate::system::radau::SystemMotion;

impl SystemMotion {
    /// Observes a joint, after [`Self::find_reactions`].
    pub fn observe_joint(&self, number: usize) -> JointObservation {
        let (coordinates, reaction_global) = (self.joint_coordinates(number), self.reaction(number));
        let Self { system, first, .. } = self;
        let times = [self.time(); 2];
        let connections = &system.connections;
        let before: usize = connections.joints[..number].iter().map(|joint| joint.row_count()).sum();
        let joint = &connections.joints[number];
        let marker = &joint.markers[0];
        let place = marker.place(marker.body().map(|b| first.body_place(system, b)).as_ref());
        let mut out = JointObservation {
            coordinates,
            work: self.joint_work(number),
            ..JointObservation::of_wrench(reaction_global, &place.axes)
        };
        let rows = before..before + joint.row_count();
        let of_rows = self.reactions[rows.clone()].iter().zip(&first.constraints.own_rates[rows]);
        out.drive_power = of_rows.map(|(lambda, rate)| -lambda * rate).sum();
        for (coordinate, force) in joint.forces() {
            let at = coordinates.along(coordinate);
            let effort = match coordinate {
                Coordinate::Turn => &mut out.turn_effort,
                Coordinate::Slide => &mut out.slide_effort,
            };
            let forces = force.at(at, times);
            *effort = forces.sum();
            out.drive_power += forces.motor * at[1];
        }
        for (coupling, of) in connections.couplings.iter().enumerate() {
            for term in of.terms.iter().filter(|term| term.joint == number) {
                let effort = match term.coordinate {
                    Coordinate::Turn => &mut out.turn_effort,
                    Coordinate::Slide => &mut out.slide_effort,
                };
                *effort += self.coupling_force(coupling) * term.factor;
            }
        }
        out
    }

    /// Observes a force element, after [`Self::find_reactions`]; zeros of one that does not show what it does.
    pub fn observe_element(&self, number: usize) -> JointObservation {
        let Self { system, first, .. } = self;
        let element = &system.connections.elements[number];
        let [i, j] = &system.connections.element_markers[number][..] else { return JointObservation::default() };
        let motions = [i, j].map(|marker| {
            let place = marker.place(marker.body().map(|b| first.body_place(system, b)).as_ref());
            system.motion_for(number, marker, first.motion_of(system, marker, &place), self.time)
        });
        let work = self.work_of_element(number);
        element.observe(&motions).map(|seen| JointObservation { work, ..seen }).unwrap_or_default()
    }
}
