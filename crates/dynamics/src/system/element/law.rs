//! Forces and moments between two markers by laws from outside: contacts, magnets, cables, controllers.

use std::fmt;
use std::sync::Arc;

use nalgebra::{Matrix3, Vector3};
use rigid_kin::transformation_matrix;

use crate::system::element::differences::difference;
use crate::system::element::{ForceElement, SetDirection};
use crate::system::marker::Marker;
use crate::system::marker::motion::{MarkerMotion, MarkerWrench};

/// The motion of the second of two markers as the first sees it, in the axes of the first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RelativeMotion {
    /// Position of the second marker from the first.
    pub position: Vector3<f64>,
    /// Axes of the second marker, as columns.
    pub axes: Matrix3<f64>,
    /// Rate of the position.
    pub velocity: Vector3<f64>,
    /// Angular velocity of the second marker less that of the first.
    pub omega: Vector3<f64>,
}

/// A law for the force and the moment on the second of two markers. They act on the first the other way round, so that the two
/// together have no resultant.
pub trait MarkerLaw: fmt::Debug + Send + Sync {
    /// The force and the moment on the second marker, in the axes of the first, at the time `times[0]`; laws with branches are
    /// taken as they are at `times[1]`.
    fn force_and_moment(&self, times: [f64; 2], motion: &RelativeMotion) -> [Vector3<f64>; 2];

    /// A continuous function that changes its sign where the law has a kink or a jump: the gap of a contact, the slack of a cable. Under
    /// step control steps end there. Without one, the work of the law shows that there is something, and steps grow short.
    fn switch(&self, times: [f64; 2], motion: &RelativeMotion) -> Option<f64> {
        let _ = (times, motion);
        None
    }

    /// Times at which the law or one of its rates jumps, rising. Steps end there.
    fn discontinuities(&self) -> Vec<f64> {
        Vec::new()
    }
}

/// The force element of a law between two markers. Its stiffness, for Newton's method, is found by differences of the law: stiff laws
/// take no shorter steps.
#[derive(Debug, Clone)]
pub struct MarkerForce {
    /// The markers.
    pub markers: [Marker; 2],
    /// The law.
    pub law: Arc<dyn MarkerLaw>,
}

impl RelativeMotion {
    fn between([i, j]: [&MarkerMotion; 2]) -> Self {
        let line = j.position_global - i.position_global;
        Self {
            position: i.axes_global.tr_mul(&line),
            axes: i.axes_global.tr_mul(&j.axes_global),
            velocity: i.axes_global.tr_mul(&(j.velocity_global - i.velocity_global - i.omega_global.cross(&line))),
            omega: i.axes_global.tr_mul(&(j.omega_global - i.omega_global)),
        }
    }

    /// The motion after a displacement or a turn of the second marker.
    fn moved(self, by: &Vector3<f64>) -> Self {
        Self { position: self.position + by, ..self }
    }

    fn turned(self, by: &Vector3<f64>) -> Self {
        Self { axes: transformation_matrix(&-by) * self.axes, ..self }
    }

    /// The motion after a change of the velocity or the angular velocity of the second marker.
    fn faster(self, by: &Vector3<f64>) -> Self {
        Self { velocity: self.velocity + by, ..self }
    }

    fn spinning(self, by: &Vector3<f64>) -> Self {
        Self { omega: self.omega + by, ..self }
    }
}

impl MarkerForce {
    // A law of two markers needs half the calls of one of any kind: its motion is the relative one, and what it does to the first
    // follows from what it does to the second.
    /// How a force or a moment, by its number, falls from where it is with a change of the motion: the matrix of differences, in the axes of
    /// the first marker.
    fn fall(
        &self,
        times: [f64; 2],
        motion: &RelativeMotion,
        (which, here): (usize, &Vector3<f64>),
        size: f64,
        change: impl Fn(RelativeMotion, &Vector3<f64>) -> RelativeMotion,
    ) -> Matrix3<f64> {
        let small = difference(size);
        let column = |k: usize| {
            (here - self.law.force_and_moment(times, &change(*motion, &Vector3::ith(k, small)))[which]) / small
        };
        Matrix3::from_columns(&[column(0), column(1), column(2)])
    }
}

impl ForceElement for MarkerForce {
    fn markers(&self) -> &[Marker] {
        &self.markers
    }

    fn is_relative(&self) -> bool {
        true
    }

    fn apply(&self, times: [f64; 2], motions: &[MarkerMotion], wrenches: &mut [MarkerWrench]) {
        let ([i, j], [on_i, on_j]) = (motions, wrenches) else { return };
        let both = self.law.force_and_moment(times, &RelativeMotion::between([i, j]));
        let [force, moment] = both.map(|vector| i.axes_global * vector);
        let line = j.position_global - i.position_global;
        (on_j.force_global, on_j.moment_global) = (force, moment);
        (on_i.force_global, on_i.moment_global) = (-force, -moment - line.cross(&force));
    }

    fn switch(&self, times: [f64; 2], motions: &[MarkerMotion]) -> Option<f64> {
        let [i, j] = motions else { return None };
        self.law.switch(times, &RelativeMotion::between([i, j]))
    }

    fn discontinuities(&self) -> Vec<f64> {
        self.law.discontinuities()
    }

    fn directions(&self) -> usize {
        6
    }

    /// Along and about the directions in which the law is stiff: eigenvectors of its differences.
    fn linearize(&self, times: [f64; 2], motions: &[MarkerMotion], set: &mut SetDirection<'_>) {
        let [i, j] = motions else { return };
        let (line, zero) = (j.position_global - i.position_global, Vector3::zeros());
        let motion = RelativeMotion::between([i, j]);
        let here = self.law.force_and_moment(times, &motion);
        let [force, moment] = [(0, &here[0]), (1, &here[1])];
        let stiffness = [
            self.fall(times, &motion, force, motion.position.norm(), |motion, by| motion.moved(by)),
            self.fall(times, &motion, moment, 0.0, |motion, by| motion.turned(by)),
        ];
        let damping = [
            self.fall(times, &motion, force, motion.velocity.norm(), |motion, by| motion.faster(by)),
            self.fall(times, &motion, moment, motion.omega.norm(), |motion, by| motion.spinning(by)),
        ];
        for which in 0..2 {
            let [stiff, damped] =
                [&stiffness[which], &damping[which]].map(|matrix| 0.5 * (matrix + matrix.transpose()));
            for (k, axis) in principal_axes(if stiff.norm() > 0.0 { &stiff } else { &damped }).iter().enumerate() {
                let of_axis = [&stiff, &damped].map(|matrix| axis.dot(&(matrix * axis)).max(0.0));
                let along = i.axes_global * axis;
                let on_markers = match which {
                    0 => [(-along, -line.cross(&along)), (along, zero)],
                    _ => [(zero, -along), (zero, along)],
                };
                let [on_i, on_j] =
                    on_markers.map(|(force_global, moment_global)| MarkerWrench { force_global, moment_global });
                set(3 * which + k, of_axis, &[on_i, on_j]);
            }
        }
    }
}

/// Off-diagonal part below which a matrix is diagonal, rounding of its differences included.
const DIAGONAL: f64 = 1e-3;

/// Eigenvectors of a symmetric matrix, that of the largest eigenvalue first; the axes themselves where it is diagonal. Stages and passes of
/// Newton's method share them, so their order and their signs stay where the matrix hardly changes.
fn principal_axes(matrix: &Matrix3<f64>) -> [Vector3<f64>; 3] {
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    let beside = matrix - Matrix3::from_diagonal(&matrix.diagonal());
    // Not so of a law that gives no numbers, which is found where it is applied.
    let has_others = beside.norm() > DIAGONAL * matrix.norm();
    if !has_others || !matrix.norm().is_finite() {
        return axes;
    }
    let eigen = matrix.symmetric_eigen();
    let mut order = [0, 1, 2];
    order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
    order.map(|k| {
        let axis: Vector3<f64> = eigen.eigenvectors.column(k).into();
        axis * axis[axis.iamax()].signum()
    })
}
