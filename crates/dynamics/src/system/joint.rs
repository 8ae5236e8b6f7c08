//! Joints: rows that hold two markers together. Table (J4) of `docs/method/systems.md`.

use nalgebra::Vector3;

use crate::history::History;
use crate::system::marker::{Marker, MarkerPlace};

/// One scalar equation between the frames of the markers i and j, with d from i to j.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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
}

/// The angle (rad) or the distance of a driven joint over time: the amplitude times the history.
#[derive(Debug, Clone)]
pub struct JointDrive {
    /// Value where the history is 1.
    pub amplitude: f64,
    /// Factor over time.
    pub history: History,
}

impl JointDrive {
    /// Its value and its rate at a time, by the branch that holds at `branch_time`.
    fn at(&self, [time, branch_time]: [f64; 2]) -> [f64; 2] {
        [self.history.at(time, branch_time), self.history.rate(time, branch_time)].map(|of| self.amplitude * of)
    }
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
    /// Drive of its driven rows.
    pub drive: Option<JointDrive>,
}

impl Joint {
    fn new(name: &str, markers: [Marker; 2], rows: &[Row]) -> Self {
        Self { name: name.to_owned(), markers, rows: rows.to_vec(), drive: None }
    }

    /// The rows of one point. Their axes are those of a flexible body, if there is one: its stiff directions then hardly turn
    /// in them within a step.
    fn point(markers: &[Marker; 2]) -> [Row; 3] {
        let of = usize::from(markers[0].flexible() == 0 && markers[1].flexible() > 0);
        [0, 1, 2].map(|axis| Row::Point { of, axis })
    }

    /// No motion is left.
    pub fn fixed(name: &str, markers: [Marker; 2]) -> Self {
        let point = Self::point(&markers);
        Self::new(name, markers, &[&point[..], &[Row::Rotation(0), Row::Rotation(1), Row::Rotation(2)]].concat())
    }

    /// A turn about the z axis, which both markers share.
    pub fn revolute(name: &str, markers: [Marker; 2]) -> Self {
        let point = Self::point(&markers);
        Self::new(name, markers, &[&point[..], &[Row::Perpendicular(2, 0), Row::Perpendicular(2, 1)]].concat())
    }

    /// A slide along the z axis of i.
    pub fn prismatic(name: &str, markers: [Marker; 2]) -> Self {
        let rows = [
            Row::Point { of: 0, axis: 0 },
            Row::Point { of: 0, axis: 1 },
            Row::Rotation(0),
            Row::Rotation(1),
            Row::Rotation(2),
        ];
        Self::new(name, markers, &rows)
    }

    /// A slide along the z axis and a turn about it.
    pub fn cylindrical(name: &str, markers: [Marker; 2]) -> Self {
        let rows = [
            Row::Point { of: 0, axis: 0 },
            Row::Point { of: 0, axis: 1 },
            Row::Perpendicular(2, 0),
            Row::Perpendicular(2, 1),
        ];
        Self::new(name, markers, &rows)
    }

    /// All turns about one point.
    pub fn spherical(name: &str, markers: [Marker; 2]) -> Self {
        let point = Self::point(&markers);
        Self::new(name, markers, &point)
    }

    /// Turns about the x axis of i and the y axis of j, which stay at right angles.
    pub fn universal(name: &str, markers: [Marker; 2]) -> Self {
        let point = Self::point(&markers);
        Self::new(name, markers, &[&point[..], &[Row::Perpendicular(0, 1)]].concat())
    }

    /// Slides in the plane at right angles to the z axis of i, and the turn about it.
    pub fn planar(name: &str, markers: [Marker; 2]) -> Self {
        Self::new(name, markers, &[Row::Point { of: 0, axis: 2 }, Row::Perpendicular(2, 0), Row::Perpendicular(2, 1)])
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

    /// Calls `each` with the wrench of each row where the markers are, at a time by the branch of another.
    pub(crate) fn wrenches(&self, places: [&MarkerPlace; 2], times: [f64; 2], mut each: impl FnMut(RowWrench)) {
        let driven = self.drive.as_ref().map_or([0.0; 2], |drive| drive.at(times));
        self.rows.iter().for_each(|row| each(row.wrench(places, driven)));
    }
}

/// A row where its markers are: its residual, and the forces and moments (global) that one unit of its multiplier puts on
/// them. Their sum has no force and no moment, also where the residual is not zero.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RowWrench {
    pub residual: f64,
    /// Rate of the residual where nothing moves: by a drive.
    pub own_rate: f64,
    /// On j; on i it is the opposite.
    pub force: Vector3<f64>,
    /// On i and on j, each at its marker.
    pub moments: [Vector3<f64>; 2],
}

impl Row {
    /// With the value and the rate of the joint's drive.
    fn wrench(self, [i, j]: [&MarkerPlace; 2], [value, rate]: [f64; 2]) -> RowWrench {
        let axis_i = |k: usize| -> Vector3<f64> { i.axes.column(k).into() };
        let axis_j = |k: usize| -> Vector3<f64> { j.axes.column(k).into() };
        let along = |of: usize, e: Vector3<f64>| {
            let d = j.position - i.position;
            let mut moments = [Vector3::zeros(); 2];
            moments[of] = e.cross(&d);
            RowWrench { residual: e.dot(&d), own_rate: 0.0, force: e, moments }
        };
        let turning = |residual: f64, moment: Vector3<f64>| RowWrench {
            residual,
            own_rate: 0.0,
            force: Vector3::zeros(),
            moments: [moment, -moment],
        };
        let held = |il: Vector3<f64>, im: Vector3<f64>, jl: Vector3<f64>, jm: Vector3<f64>| {
            turning(0.5 * (im.dot(&jl) - il.dot(&jm)), 0.5 * (im.cross(&jl) - il.cross(&jm)))
        };
        match self {
            Self::Point { of, axis } => along(of, if of == 0 { axis_i(axis) } else { axis_j(axis) }),
            Self::Perpendicular(of_i, of_j) => {
                let (a, b) = (axis_i(of_i), axis_j(of_j));
                turning(a.dot(&b), a.cross(&b))
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
            Self::DrivenPoint => {
                let wrench = along(0, axis_i(2));
                RowWrench { residual: wrench.residual - value, own_rate: -rate, ..wrench }
            }
        }
    }
}
