//! A joint, a spring or a bushing at one time, as it is seen in a row of results.

use nalgebra::{Matrix3, Vector3};

use crate::system::joint::coordinate::JointCoordinates;
use crate::system::joint::work::JointWork;
use crate::system::marker::motion::MarkerWrench;

/// A joint at one time; or a spring or a bushing, which have no coordinates.
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
    /// The line between the markers of a spring.
    pub line: LineObservation,
}

/// The line between the two markers of a spring at one time.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct LineObservation {
    /// Its length.
    pub length: f64,
    /// Rate of the length.
    pub rate: f64,
    /// Force by which the spring and the damper pull the markers together; negative where they push.
    pub pull: f64,
}

impl JointObservation {
    /// A wrench on the second marker, as an element puts it there; `axes_global` are those of the first.
    pub(crate) fn of_wrench(reaction_global: MarkerWrench, axes_global: &Matrix3<f64>) -> Self {
        Self {
            reaction_global,
            force_marker: axes_global.tr_mul(&reaction_global.force_global),
            moment_marker: axes_global.tr_mul(&reaction_global.moment_global),
            ..Self::default()
        }
    }

    /// True if all its numbers are finite.
    pub fn is_finite(&self) -> bool {
        let Self { coordinates, reaction_global, force_marker, moment_marker, turn_effort, slide_effort, line, .. } =
            self;
        let MarkerWrench { force_global, moment_global } = reaction_global;
        let vectors = force_global.iter().chain(moment_global).chain(force_marker).chain(moment_marker);
        let JointWork { drive, spring, loss } = &self.work;
        let LineObservation { length, rate, pull } = line;
        let numbers = [turn_effort, slide_effort, &self.drive_power, drive, spring, loss, length, rate, pull];
        vectors.chain(&coordinates.list()).chain(numbers).all(|number| number.is_finite())
    }
}
