//! A joint at one time, as it is seen in a row of results.

use nalgebra::Vector3;

use crate::system::joint::coordinate::{Coordinate, JointCoordinates};
use crate::system::joint::work::JointWork;
use crate::system::marker::motion::MarkerWrench;
use crate::system::radau::SystemMotion;

/// A joint at one time.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct JointObservation {
    /// Where its second marker is against the first.
    pub coordinates: JointCoordinates,
    /// Force and moment of its rows on the second marker, drive included; on the first they are the opposite, about the same point.
    pub reaction_global: MarkerWrench,
    /// The same force, in the axes of the first marker.
    pub force_marker: Vector3<f64>,
    /// The same moment, in the axes of the first marker.
    pub moment_marker: Vector3<f64>,
    /// Moment about the z axis of its spring, damper, stops, friction, motor and couplings, on the second marker.
    pub turn_effort: f64,
    /// Force of the same along the z axis.
    pub slide_effort: f64,
    /// Power of its drive and its motors.
    pub drive_power: f64,
    /// Works since the beginning.
    pub work: JointWork,
}

impl JointObservation {
    /// True if all its numbers are finite.
    pub fn is_finite(&self) -> bool {
        let Self { coordinates, reaction_global, force_marker, moment_marker, turn_effort, slide_effort, .. } = self;
        let MarkerWrench { force_global, moment_global } = reaction_global;
        let vectors = force_global.iter().chain(moment_global).chain(force_marker).chain(moment_marker);
        let JointWork { drive, spring, loss } = &self.work;
        let numbers = [turn_effort, slide_effort, &self.drive_power, drive, spring, loss];
        vectors.chain(&coordinates.list()).chain(numbers).all(|number| number.is_finite())
    }
}

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
            reaction_global,
            force_marker: place.axes.tr_mul(&reaction_global.force_global),
            moment_marker: place.axes.tr_mul(&reaction_global.moment_global),
            work: self.joint_work(number),
            ..JointObservation::default()
        };
        let rows = before..before + joint.row_count();
        let of_rows = self.reactions[rows.clone()].iter().zip(&first.constraints.own_rates[rows]);
        out.drive_power = of_rows.map(|(lambda, rate)| -lambda * rate).sum();
        for (coordinate, force) in joint.forces() {
            let (at, effort) = match coordinate {
                Coordinate::Turn => ([coordinates.turn, coordinates.turn_rate], &mut out.turn_effort),
                Coordinate::Slide => ([coordinates.slide, coordinates.slide_rate], &mut out.slide_effort),
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
}
