//! Joints: rows that hold two markers together. Table (J4) of `docs/method/systems.md`.

use nalgebra::Vector3;

use crate::system::marker::{Marker, MarkerPlace};

/// One scalar equation between the frames of the markers i and j, with d from i to j.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Row {
    /// d has no component along this axis of i.
    Point(usize),
    /// This axis of i is at right angles to that one of j.
    Perpendicular(usize, usize),
    /// j is not turned against i about this axis, as long as it is hardly turned about the others.
    Rotation(usize),
}

/// A joint between two markers, i and j.
#[derive(Debug, Clone)]
pub struct Joint {
    /// Its name in errors and results.
    pub name: String,
    /// i and j.
    pub markers: [Marker; 2],
    /// Its rows.
    pub rows: Vec<Row>,
}

const POINT: [Row; 3] = [Row::Point(0), Row::Point(1), Row::Point(2)];

impl Joint {
    fn new(name: &str, markers: [Marker; 2], rows: &[Row]) -> Self {
        Self { name: name.to_owned(), markers, rows: rows.to_vec() }
    }

    /// No motion is left.
    pub fn fixed(name: &str, markers: [Marker; 2]) -> Self {
        Self::new(name, markers, &[&POINT[..], &[Row::Rotation(0), Row::Rotation(1), Row::Rotation(2)]].concat())
    }

    /// A turn about the z axis, which both markers share.
    pub fn revolute(name: &str, markers: [Marker; 2]) -> Self {
        Self::new(name, markers, &[&POINT[..], &[Row::Perpendicular(2, 0), Row::Perpendicular(2, 1)]].concat())
    }

    /// A slide along the z axis of i.
    pub fn prismatic(name: &str, markers: [Marker; 2]) -> Self {
        let rows = [Row::Point(0), Row::Point(1), Row::Rotation(0), Row::Rotation(1), Row::Rotation(2)];
        Self::new(name, markers, &rows)
    }

    /// A slide along the z axis and a turn about it.
    pub fn cylindrical(name: &str, markers: [Marker; 2]) -> Self {
        let rows = [Row::Point(0), Row::Point(1), Row::Perpendicular(2, 0), Row::Perpendicular(2, 1)];
        Self::new(name, markers, &rows)
    }

    /// All turns about one point.
    pub fn spherical(name: &str, markers: [Marker; 2]) -> Self {
        Self::new(name, markers, &POINT)
    }

    /// Turns about the x axis of i and the y axis of j, which stay at right angles.
    pub fn universal(name: &str, markers: [Marker; 2]) -> Self {
        Self::new(name, markers, &[&POINT[..], &[Row::Perpendicular(0, 1)]].concat())
    }

    /// Slides in the plane at right angles to the z axis of i, and the turn about it.
    pub fn planar(name: &str, markers: [Marker; 2]) -> Self {
        Self::new(name, markers, &[Row::Point(2), Row::Perpendicular(2, 0), Row::Perpendicular(2, 1)])
    }
}

/// A row where its markers are: its residual, and the forces and moments (global) that one unit of its multiplier puts on
/// them. Their sum has no force and no moment, also where the residual is not zero.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RowWrench {
    pub residual: f64,
    /// On j; on i it is the opposite.
    pub force: Vector3<f64>,
    /// On i and on j, each at its marker.
    pub moments: [Vector3<f64>; 2],
}

impl Row {
    pub(crate) fn wrench(self, [i, j]: [&MarkerPlace; 2]) -> RowWrench {
        let axis_i = |k: usize| -> Vector3<f64> { i.axes.column(k).into() };
        let axis_j = |k: usize| -> Vector3<f64> { j.axes.column(k).into() };
        let turning = |residual: f64, moment: Vector3<f64>| RowWrench {
            residual,
            force: Vector3::zeros(),
            moments: [moment, -moment],
        };
        match self {
            Self::Point(axis) => {
                let (e, d) = (axis_i(axis), j.position - i.position);
                RowWrench { residual: e.dot(&d), force: e, moments: [e.cross(&d), Vector3::zeros()] }
            }
            Self::Perpendicular(of_i, of_j) => {
                let (a, b) = (axis_i(of_i), axis_j(of_j));
                turning(a.dot(&b), a.cross(&b))
            }
            Self::Rotation(axis) => {
                let (l, m) = ((axis + 1) % 3, (axis + 2) % 3);
                let (il, im, jl, jm) = (axis_i(l), axis_i(m), axis_j(l), axis_j(m));
                turning(0.5 * (im.dot(&jl) - il.dot(&jm)), 0.5 * (im.cross(&jl) - il.cross(&jm)))
            }
        }
    }
}
