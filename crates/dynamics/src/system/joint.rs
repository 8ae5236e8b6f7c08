//! Joints: rows that hold two markers together, and forces along what they leave free.

pub(crate) mod change;
pub(crate) mod coordinate;
pub(crate) mod coupling;
pub(crate) mod drive;
pub(crate) mod equation;
pub(crate) mod far;
pub(crate) mod force;
pub(crate) mod law;
pub(crate) mod observation;
pub(crate) mod row;
pub(crate) mod work;
pub(crate) mod wrench;

use std::sync::Arc;

use crate::history::History;
use crate::system::joint::coordinate::Coordinate;
use crate::system::joint::drive::JointDrive;
use crate::system::joint::equation::JointEquation;
use crate::system::joint::force::JointForce;
use crate::system::joint::row::Row;
use crate::system::marker::Marker;

/// A joint between two markers, i and j.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub struct Joint {
    /// Its name in errors and results.
    pub name: String,
    /// i and j.
    pub markers: [Marker; 2],
    /// Rows on the two markers.
    pub rows: Vec<Row>,
    /// Where its ends are several places each: rows on pairs of them. The two markers are then their means.
    pub parts: Vec<JointPart>,
    /// Drive of its driven rows.
    pub drive: Option<JointDrive>,
    /// The moment about its z axis.
    pub turn_force: Option<JointForce>,
    /// The force along its z axis.
    pub slide_force: Option<JointForce>,
}

/// A pair of places of a joint's ends, with rows of its own.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub struct JointPart {
    /// On i and on j.
    pub markers: [Marker; 2],
    /// Its rows.
    pub rows: Vec<Row>,
}

impl JointPart {
    /// The rows of [`Joint::locked`] on two places.
    pub fn locked(markers: [Marker; 2], displacements: [bool; 3], turns: [bool; 3]) -> Self {
        let rows = locked_rows(&markers, displacements, turns);
        Self { markers, rows }
    }
}

impl Joint {
    /// A joint of these rows.
    pub fn new(name: &str, markers: [Marker; 2], rows: Vec<Row>) -> Self {
        Self {
            name: name.to_owned(),
            markers,
            rows,
            parts: Vec::new(),
            drive: None,
            turn_force: None,
            slide_force: None,
        }
    }

    /// Displacements along and turns about axes of i that are not free. One turn alone that is not free is that of two axes, the
    /// next of i and the one after of j, which stay at right angles.
    ///
    /// The axes of a whole point are those of a flexible body, if there is one: its stiff directions then hardly turn in them
    /// within a step.
    pub fn locked(name: &str, markers: [Marker; 2], displacements: [bool; 3], turns: [bool; 3]) -> Self {
        let rows = locked_rows(&markers, displacements, turns);
        Self::new(name, markers, rows)
    }

    /// The same joint with rows on pairs of places beside its own.
    #[must_use]
    pub fn with_parts(self, parts: Vec<JointPart>) -> Self {
        Self { parts, ..self }
    }

    /// No motion is left.
    pub fn fixed(name: &str, markers: [Marker; 2]) -> Self {
        Self::locked(name, markers, [true; 3], [true; 3])
    }

    /// A turn about the z axis, which both markers share.
    pub fn revolute(name: &str, markers: [Marker; 2]) -> Self {
        Self::locked(name, markers, [true; 3], [true, true, false])
    }

    /// A slide along the z axis of i.
    pub fn prismatic(name: &str, markers: [Marker; 2]) -> Self {
        Self::locked(name, markers, [true, true, false], [true; 3])
    }

    /// A slide along the z axis and a turn about it.
    pub fn cylindrical(name: &str, markers: [Marker; 2]) -> Self {
        Self::locked(name, markers, [true, true, false], [true, true, false])
    }

    /// All turns about one point.
    pub fn spherical(name: &str, markers: [Marker; 2]) -> Self {
        Self::locked(name, markers, [true; 3], [false; 3])
    }

    /// Turns about the x axis of i and the y axis of j, which stay at right angles.
    pub fn universal(name: &str, markers: [Marker; 2]) -> Self {
        Self::locked(name, markers, [true; 3], [false, false, true])
    }

    /// Slides in the plane at right angles to the z axis of i, and the turn about it.
    pub fn planar(name: &str, markers: [Marker; 2]) -> Self {
        Self::locked(name, markers, [false, false, true], [true, true, false])
    }

    /// The same joint, turned about its z axis by a drive.
    #[must_use]
    pub fn turned_by(self, drive: JointDrive) -> Self {
        self.driven(Row::DrivenRotation, drive)
    }

    /// The same joint, moved along its z axis by a drive.
    #[must_use]
    pub fn moved_by(self, drive: JointDrive) -> Self {
        self.driven(Row::DrivenPoint, drive)
    }

    fn driven(mut self, row: Row, drive: JointDrive) -> Self {
        self.rows.push(row);
        Self { drive: Some(drive), ..self }
    }

    /// The same joint with one more equation, from outside.
    #[must_use]
    pub fn with_equation(mut self, equation: Arc<dyn JointEquation>) -> Self {
        self.rows.push(Row::Outside(equation));
        self
    }

    /// The same joint with a moment about its z axis, or a force along it.
    #[must_use]
    pub fn with_force(mut self, along: Coordinate, force: JointForce) -> Self {
        match along {
            Coordinate::Turn => self.turn_force = Some(force),
            Coordinate::Slide => self.slide_force = Some(force),
        }
        self
    }

    /// Its forces and their coordinates.
    pub(crate) fn forces(&self) -> impl Iterator<Item = (Coordinate, &JointForce)> {
        let of = |coordinate, force| Option::map(force, |force| (coordinate, force));
        [of(Coordinate::Turn, self.turn_force.as_ref()), of(Coordinate::Slide, self.slide_force.as_ref())]
            .into_iter()
            .flatten()
    }

    /// True if its drive turns it.
    pub fn is_turned_by_drive(&self) -> bool {
        self.rows.iter().any(|row| matches!(row, Row::DrivenRotation))
    }

    /// Histories over time: of its drive and its motors.
    pub fn histories(&self) -> impl Iterator<Item = &History> {
        let motors = self.forces().filter_map(|(_, force)| force.motor.as_ref());
        self.drive.iter().chain(motors).map(|drive| &drive.history)
    }

    /// Its equations from outside, with the markers of each.
    pub(crate) fn equations(&self) -> impl Iterator<Item = (&[Marker; 2], &dyn JointEquation)> {
        self.groups()
            .flat_map(|(markers, rows)| rows.iter().filter_map(Row::outside).map(move |equation| (markers, equation)))
    }

    /// Number of its rows: on its markers, then on its parts.
    pub fn row_count(&self) -> usize {
        self.groups().map(|(_, rows)| rows.len()).sum()
    }

    /// The markers of the joint, then the markers of its parts.
    pub(crate) fn all_markers(&self) -> Vec<&Marker> {
        self.groups().flat_map(|(markers, _)| markers).collect()
    }

    /// Its markers with their rows, then those of its parts.
    pub(crate) fn groups(&self) -> impl Iterator<Item = (&[Marker; 2], &[Row])> {
        let of_parts = self.parts.iter().map(|part| (&part.markers, &part.rows[..]));
        std::iter::once((&self.markers, &self.rows[..])).chain(of_parts)
    }

    /// The value and the rate of its drive at a time by the branch of another; zero without one.
    pub(crate) fn driven_at(&self, times: [f64; 2]) -> [f64; 2] {
        self.drive.as_ref().map_or([0.0; 2], |drive| drive.at(times))
    }
}

/// Rows for displacements and turns that are not free, see [`Joint::locked`].
fn locked_rows(markers: &[Marker; 2], displacements: [bool; 3], turns: [bool; 3]) -> Vec<Row> {
    let is_point = displacements == [true; 3];
    let of = usize::from(is_point && markers[0].coordinates() == 0 && markers[1].coordinates() > 0);
    let axes = |list: [bool; 3], is: bool| (0..3).filter(move |axis| list[*axis] == is);
    let mut rows: Vec<Row> = axes(displacements, true).map(|axis| Row::Point { of, axis }).collect();
    match axes(turns, true).count() {
        3 => rows.extend([0, 1, 2].map(Row::Rotation)),
        2 => rows
            .extend(axes(turns, false).flat_map(|free| [1, 2].map(|next| Row::Perpendicular(free, (free + next) % 3)))),
        _ => rows.extend(axes(turns, true).map(|axis| Row::Perpendicular((axis + 1) % 3, (axis + 2) % 3))),
    }
    rows
}
