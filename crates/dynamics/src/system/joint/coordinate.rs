//! The turn and the slide of a joint: Eqs. (J11) of `docs/method/systems.md`.

use std::f64::consts::TAU;

use nalgebra::Vector3;
use rigid_kin::transformation_matrix;
use serde::{Deserialize, Serialize};

use crate::system::joint::wrench::RowWrench;
use crate::system::marker::MarkerPlace;

/// A coordinate that a joint leaves free.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Coordinate {
    /// The angle about the z axis of the first end, from its x axis to that of the second, rad. Full turns are counted.
    Turn,
    /// The distance along the z axis of the first end.
    Slide,
}

impl Coordinate {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Turn => "turn",
            Self::Slide => "slide",
        }
    }
}

/// The coordinates of a joint and their rates.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct JointCoordinates {
    /// Angle about the z axis of the first marker, rad, with full turns.
    pub turn: f64,
    /// Rate of the angle, rad per time.
    pub turn_rate: f64,
    /// Distance along the z axis of the first marker.
    pub slide: f64,
    /// Rate of the distance.
    pub slide_rate: f64,
}

impl JointCoordinates {
    /// They.
    pub(crate) fn list(&self) -> [f64; 4] {
        [self.turn, self.turn_rate, self.slide, self.slide_rate]
    }

    /// One of them, with its rate.
    pub(crate) fn along(&self, coordinate: Coordinate) -> [f64; 2] {
        match coordinate {
            Coordinate::Turn => [self.turn, self.turn_rate],
            Coordinate::Slide => [self.slide, self.slide_rate],
        }
    }
}

impl Coordinate {
    /// The coordinate, and the wrenches that one unit of its force puts on the markers. Of all angles that differ by full turns
    /// it is the next to `expected_turn`.
    pub(crate) fn wrench(self, places: [&MarkerPlace; 2], expected_turn: f64) -> RowWrench {
        let [i, j] = places;
        match self {
            Self::Turn => {
                let x = i.axes.tr_mul(&j.axes.column(0));
                let angle = x.y.atan2(x.x);
                // With x = ω × x, the rate of the angle is e·ω.
                let square = x.x * x.x + x.y * x.y;
                let tilt = if square > SHORT { x.z / square } else { 0.0 };
                let e = i.axes * Vector3::new(-tilt * x.x, -tilt * x.y, 1.0);
                RowWrench::turning(angle + TAU * ((expected_turn - angle) / TAU).round(), -e)
            }
            Self::Slide => RowWrench::along(places, 0, i.axes.column(2).into()),
        }
    }
}

/// Most pieces of a path: 160 turns.
const MAX_PIECES: f64 = 1e3;

/// The turn of a joint at the end of a path on which each of its two markers turns about a fixed axis by a rotation vector (global), from
/// `turn` where the path begins. The path is followed in pieces on which the angle changes by less than half a turn.
pub(crate) fn turn_along(places: [&MarkerPlace; 2], paths: [&Vector3<f64>; 2], turn: f64) -> f64 {
    let pieces = (paths[0].norm() + paths[1].norm()).ceil();
    // Newton's method refuses where increments are no longer of any use.
    if !(1.0..MAX_PIECES).contains(&pieces) {
        return turn;
    }
    let mut reached = turn;
    // The end itself is the caller's, who takes the angle next to what is returned.
    let mut piece = 0.0;
    while piece < pieces {
        let left = 1.0 - piece / pieces;
        // An attitude that is turned back by the rest of the path.
        let [i, j] = [0, 1].map(|k| {
            let mut place = *places[k];
            place.axes = transformation_matrix(&(paths[k] * left)) * place.axes;
            place
        });
        reached = Coordinate::Turn.wrench([&i, &j], reached).residual;
        piece += 1.0;
    }
    reached
}

/// The square of the x axis of j across the z axis of i below which there is no angle.
pub(crate) const SHORT: f64 = 1e-20;
