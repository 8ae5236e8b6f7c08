//! The rows of joints: table (J4) of `docs/method/systems.md`.

use std::sync::Arc;

use nalgebra::Vector3;

use crate::system::joint::coordinate::Coordinate;
use crate::system::joint::equation::{self, JointEquation};
use crate::system::joint::wrench::RowWrench;
use crate::system::marker::MarkerPlace;

/// One scalar equation between the frames of the markers i and j, with d from i to j.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub enum Row {
    /// d has no component along an axis of one marker (0 for i, 1 for j).
    Point {
        /// The marker.
        of: usize,
        /// Its axis.
        axis: usize,
    },
    /// This axis of i is at right angles to that one of j.
    Perpendicular(usize, usize),
    /// j is not turned against i about this axis, as long as it is hardly turned about the others.
    Rotation(usize),
    /// j is turned against i about the z axis by the value of the joint's drive.
    DrivenRotation,
    /// d along the z axis of i is the value of the joint's drive.
    DrivenPoint,
    /// An equation from outside.
    #[serde(skip)]
    Outside(Arc<dyn JointEquation>),
}

impl Row {
    /// Its equation, if that is from outside.
    pub(crate) fn outside(&self) -> Option<&dyn JointEquation> {
        match self {
            Self::Outside(equation) => Some(&**equation),
            _ => None,
        }
    }

    /// With the value and the rate of the joint's drive.
    pub(crate) fn wrench(&self, places: [&MarkerPlace; 2], [value, rate]: [f64; 2]) -> RowWrench {
        let [i, j] = places;
        let axis_i = |k: usize| -> Vector3<f64> { i.axes.column(k).into() };
        let axis_j = |k: usize| -> Vector3<f64> { j.axes.column(k).into() };
        let held = |il: Vector3<f64>, im: Vector3<f64>, jl: Vector3<f64>, jm: Vector3<f64>| {
            RowWrench::turning(0.5 * (im.dot(&jl) - il.dot(&jm)), 0.5 * (im.cross(&jl) - il.cross(&jm)))
        };
        match *self {
            Self::Point { of, axis } => RowWrench::along(places, of, if of == 0 { axis_i(axis) } else { axis_j(axis) }),
            Self::Perpendicular(of_i, of_j) => {
                let (a, b) = (axis_i(of_i), axis_j(of_j));
                RowWrench::turning(a.dot(&b), a.cross(&b))
            }
            Self::Rotation(axis) => {
                let (l, m) = ((axis + 1) % 3, (axis + 2) % 3);
                held(axis_i(l), axis_i(m), axis_j(l), axis_j(m))
            }
            Self::DrivenRotation => {
                // The axes of j, turned back.
                let (sine, cosine) = value.sin_cos();
                let (l, m) = (axis_j(0) * cosine - axis_j(1) * sine, axis_j(0) * sine + axis_j(1) * cosine);
                let own_rate = -0.5 * rate * (axis_i(1).dot(&m) + axis_i(0).dot(&l));
                RowWrench { own_rate, ..held(axis_i(0), axis_i(1), l, m) }
            }
            Self::Outside(ref equation) => equation::wrench(&**equation, places),
            Self::DrivenPoint => {
                let slide = Coordinate::Slide.wrench(places, 0.0);
                RowWrench { residual: slide.residual - value, own_rate: -rate, ..slide }
            }
        }
    }
}
