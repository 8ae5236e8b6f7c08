//! The first order of the wrenches of rows and coordinates: how they change where their two markers move and turn a little.
//!
//! Eqs. (L5) of `docs/method/systems.md`: an axis a of a marker that turns by ψ (global) changes by ψ×a.

use nalgebra::Vector3;

use crate::system::joint::coordinate::{Coordinate, SHORT};
use crate::system::joint::equation::{self, JointEquation, RelativePlace, derivative_changes};
use crate::system::joint::row::Row;
use crate::system::joint::wrench::RowWrench;
use crate::system::marker::MarkerPlace;

/// A small displacement and a small turn of a marker, global.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct FrameChange {
    pub displacement: Vector3<f64>,
    pub turn: Vector3<f64>,
}

/// The change of the wrenches of one unit: of the force on j, which is the opposite of that on i, and of the moments on both.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WrenchChange {
    pub force: Vector3<f64>,
    pub moments: [Vector3<f64>; 2],
}

/// An axis and its change.
type Axis = [Vector3<f64>; 2];

impl WrenchChange {
    fn along([i, j]: [&MarkerPlace; 2], changes: [&FrameChange; 2], of: usize, axis: usize) -> Self {
        let [e, de] = axis_of([i, j][of], changes[of], axis);
        let d = j.position - i.position;
        let moved = changes[1].displacement - changes[0].displacement;
        let mut moments = [Vector3::zeros(); 2];
        moments[of] = de.cross(&d) + e.cross(&moved);
        Self { force: de, moments }
    }

    fn turning(moment: Vector3<f64>) -> Self {
        Self { force: Vector3::zeros(), moments: [moment, -moment] }
    }

    /// Change of half the difference of a·b and c·d.
    fn held([a, b, c, d]: [Axis; 4]) -> Self {
        Self::turning(0.5 * (cross_change(a, b) - cross_change(c, d)))
    }

    /// The change of an equation from outside. `length` is that of the bodies.
    fn of_equation(
        equation: &dyn JointEquation,
        [i, j]: [&MarkerPlace; 2],
        [of_i, of_j]: [&FrameChange; 2],
        length: f64,
    ) -> Self {
        let d = j.position - i.position;
        let moved = of_j.displacement - of_i.displacement;
        let RowWrench { force, moments: [_, moment], .. } = equation::wrench(equation, [i, j]);
        // As i sees it.
        let displacement = i.axes.tr_mul(&(moved - of_i.turn.cross(&d)));
        let turn = i.axes.tr_mul(&(of_j.turn - of_i.turn));
        let place = RelativePlace::between([i, j]);
        let [by_position, by_turn] = derivative_changes(equation, &place, [&displacement, &turn], length);
        let d_force = of_i.turn.cross(&force) + i.axes * by_position;
        let d_moment = of_i.turn.cross(&moment) + i.axes * by_turn;
        Self { force: d_force, moments: [d_force.cross(&d) + force.cross(&moved) - d_moment, d_moment] }
    }

    /// On i and on j: forces and moments.
    pub fn on_both(&self) -> [[Vector3<f64>; 2]; 2] {
        [[-self.force, self.moments[0]], [self.force, self.moments[1]]]
    }
}

fn axis_of(place: &MarkerPlace, change: &FrameChange, axis: usize) -> Axis {
    let e: Vector3<f64> = place.axes.column(axis).into();
    [e, change.turn.cross(&e)]
}

fn cross_change([a, da]: Axis, [b, db]: Axis) -> Vector3<f64> {
    da.cross(&b) + a.cross(&db)
}

impl Row {
    /// How its wrench changes, with the value of the joint's drive as it is. `length` is that of the bodies, for equations from outside.
    pub(crate) fn wrench_change(
        &self,
        places: [&MarkerPlace; 2],
        driven: f64,
        changes: [&FrameChange; 2],
        length: f64,
    ) -> WrenchChange {
        let of_i = |axis: usize| axis_of(places[0], changes[0], axis);
        let of_j = |axis: usize| axis_of(places[1], changes[1], axis);
        match *self {
            Self::Outside(ref equation) => WrenchChange::of_equation(&**equation, places, changes, length),
            Self::Point { of, axis } => WrenchChange::along(places, changes, of, axis),
            Self::Perpendicular(i, j) => WrenchChange::turning(cross_change(of_i(i), of_j(j))),
            Self::Rotation(axis) => {
                let (l, m) = ((axis + 1) % 3, (axis + 2) % 3);
                WrenchChange::held([of_i(m), of_j(l), of_i(l), of_j(m)])
            }
            Self::DrivenRotation => {
                // The axes of j, turned back.
                let (sine, cosine) = driven.sin_cos();
                let (x, y) = (of_j(0), of_j(1));
                let l = [0, 1].map(|k| x[k] * cosine - y[k] * sine);
                let m = [0, 1].map(|k| x[k] * sine + y[k] * cosine);
                WrenchChange::held([of_i(1), l, of_i(0), m])
            }
            Self::DrivenPoint => Coordinate::Slide.wrench_change(places, changes),
        }
    }
}

impl Coordinate {
    /// How the wrench of one unit of its force changes.
    pub(crate) fn wrench_change(self, places: [&MarkerPlace; 2], changes: [&FrameChange; 2]) -> WrenchChange {
        let [i, j] = places;
        match self {
            Self::Turn => {
                let x = i.axes.tr_mul(&j.axes.column(0));
                let relative = i.axes.tr_mul(&(changes[1].turn - changes[0].turn));
                let dx = relative.cross(&x);
                let square = x.x * x.x + x.y * x.y;
                let (tilt, d_tilt) = if square > SHORT {
                    (x.z / square, dx.z / square - x.z * 2.0 * (x.x * dx.x + x.y * dx.y) / (square * square))
                } else {
                    (0.0, 0.0)
                };
                let e = i.axes * Vector3::new(-tilt * x.x, -tilt * x.y, 1.0);
                let in_i = Vector3::new(-d_tilt * x.x - tilt * dx.x, -d_tilt * x.y - tilt * dx.y, 0.0);
                WrenchChange::turning(-(changes[0].turn.cross(&e) + i.axes * in_i))
            }
            Self::Slide => WrenchChange::along(places, changes, 0, 2),
        }
    }
}
