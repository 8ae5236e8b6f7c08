//! A load as it excites the rigid motions and each mode.

use dynamics::{History, LoadFrame, Pattern, SharedLoad};
use nalgebra::{Matrix3, Matrix3xX, Vector3};

use crate::motion::case::{Case, StaticCompliance};
use crate::motion::course::Course;
use crate::table::relative::relative;

/// A part of forces that is rounding where they cancel: a mesh that is symmetric is so to the digits of its nodes.
pub(crate) const CANCELLED: f64 = 1e-9;

/// A load: its largest forces on the translations, the rotations and each mode where its history is 1.
#[derive(Debug, Clone)]
pub(crate) struct Source {
    pub translation: f64,
    pub rotation: f64,
    /// nf; and as the load meets the body at the beginning, with its sign.
    pub modal: Vec<f64>,
    pub modal_at_start: Vec<f64>,
    pub history: History,
    /// Matrix that gives its forces on the rotations, where its history is 1, by its direction, which it has at the beginning in body axes.
    pub turning: Matrix3<f64>,
    pub vector: Vector3<f64>,
    /// Displacement of each mode where the load acts (nf).
    shapes: Vec<Vector3<f64>>,
    pub course: Course,
    /// True if its direction turns in the body as the body turns, by `turn` at the most.
    pub dead: bool,
    turn: f64,
    pub gravity: bool,
}

/// Displacement of a point in a mode, of the largest there is, that is rounding: gravity neither turns a free body nor
/// moves its modes.
const ROUNDING: f64 = 1e-10;

impl Source {
    /// The source of a load on the body of `case` that may turn by `turn` rad. A load that is no pattern of forces times a
    /// history
    /// counts for nothing: what it will do is not known before the run.
    fn new(load: &SharedLoad, course: &Course, turn: f64, gravity: bool, case: &Case) -> Self {
        let nothing = || {
            let columns = vec![Vector3::zeros(); 6 + case.body.flexible()];
            Pattern { columns, vector: Vector3::x(), frame: LoadFrame::Body, local: false }
        };
        let Pattern { columns, vector, frame, local } = load.pattern().unwrap_or_else(nothing);
        let vector = if frame == LoadFrame::Global { case.initial.attitude.to_body(&vector) } else { vector };
        let dead = frame == LoadFrame::Global && turn > 0.0;
        let astray = if dead { turn.min(1.0) } else { 0.0 };
        let largest = |rows: &[Vector3<f64>]| {
            let rows = Matrix3xX::from_columns(rows);
            let worst = (&rows * rows.transpose()).symmetric_eigenvalues().max().max(0.0).sqrt() * vector.norm();
            ((rows.transpose() * vector).norm() + astray * worst).min(worst)
        };
        let turning = &columns[3..6];
        let arm = case.body.rotation_basis.norm() * case.length;
        let is_rounding = local && turning.iter().all(|column| column.norm() <= ROUNDING * arm);
        let moved = |of: &dyn Fn(&Vector3<f64>) -> f64| -> Vec<f64> {
            let modes = columns[6..].iter().zip(case.peaks);
            modes.map(|(shape, peak)| if local && shape.norm() <= ROUNDING * peak { 0.0 } else { of(shape) }).collect()
        };
        Self {
            translation: largest(&columns[..3]),
            rotation: if is_rounding { 0.0 } else { largest(turning) },
            modal: moved(&|shape| largest(&[*shape])),
            modal_at_start: moved(&|shape| shape.dot(&vector)),
            history: load.history().cloned().unwrap_or(History::Constant),
            turning: if is_rounding {
                Matrix3::zeros()
            } else {
                Matrix3::from_columns(&[columns[3], columns[4], columns[5]]).transpose()
            },
            vector,
            shapes: columns[6..].to_vec(),
            course: course.clone(),
            dead,
            turn,
            gravity,
        }
    }

    /// The sources of all loads of a case, whose courses are `courses`, on a body that may turn by `turn` rad.
    pub(crate) fn all(case: &Case, courses: &[Course], turn: f64) -> Vec<Self> {
        let of = |(i, (load, course))| {
            let gravity = case.is_gravity.get(i).is_some_and(|is_gravity| *is_gravity);
            Self::new(load, course, turn, gravity, case)
        };
        case.loads.iter().zip(courses).enumerate().map(of).collect()
    }

    /// Largest part of a static response that the first `keep` modes, of frequencies `omega`, leave out where the load acts.
    /// Responses in other directions than the first count as far as the body may turn.
    pub(crate) fn left_out(&self, whole: &StaticCompliance, omega: &[f64], keep: usize) -> f64 {
        let part = |whole: f64, modal: &dyn Fn(usize) -> f64| -> f64 {
            let carried: f64 = (0..keep).map(|k| (modal(k) / omega[k]).powi(2)).sum();
            if whole > 0.0 { relative((whole - carried).max(0.0), whole) } else { 0.0 }
        };
        let at_start = part(whole.at_start, &|k| self.modal_at_start[k]);
        let astray = if self.dead { self.turn.min(1.0).powi(2) } else { 0.0 };
        let turned = whole.turned.iter().map(|(vector, work)| astray * part(*work, &|k| self.shapes[k].dot(vector)));
        turned.fold(at_start, f64::max)
    }

    /// Largest impulse where the force is 1; with a direction a(t) that turns, by parts: `|∫ h a| ≤ max|∫h| (1 + ∫|a'|)`.
    pub(crate) fn impulse(&self) -> f64 {
        (self.course.net_integral * (1.0 + self.turn)).min(self.course.magnitude_integral)
    }
}
