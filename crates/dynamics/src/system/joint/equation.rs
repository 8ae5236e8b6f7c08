//! Equations of joints from outside: a point on a curve or a surface, a cam, a rod of one length.

use std::fmt;

use nalgebra::{Matrix3, Vector3};
use rigid_kin::transformation_matrix;

use crate::system::joint::wrench::RowWrench;
use crate::system::marker::MarkerPlace;

/// The place of the second of two markers as the first sees it, in the axes of the first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RelativePlace {
    /// Position of the second marker from the first.
    pub position: Vector3<f64>,
    /// Axes of the second marker, as columns.
    pub axes: Matrix3<f64>,
}

/// An equation of a joint where its markers are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EquationValue {
    /// The value that the joint keeps at zero. It should be a length or an angle, so that its rounding is that of other joints.
    pub residual: f64,
    /// Its derivative by the position of the second marker.
    pub by_position: Vector3<f64>,
    /// Its derivative by a small turn of the second marker about that marker, in the axes of the first.
    pub by_turn: Vector3<f64>,
}

/// One scalar equation between two markers: a row of a joint from outside, [`Row::Outside`](crate::Row::Outside). It depends on
/// nothing but their places. The force that keeps it does no work.
pub trait JointEquation: fmt::Debug + Send + Sync {
    /// The equation and its derivatives. A run in which they do not fit each other is refused at the beginning.
    fn value(&self, place: &RelativePlace) -> EquationValue;
}

/// An equation from a closure.
///
/// ```
/// use dynamics::nalgebra::Vector3;
/// use dynamics::{EquationValue, JointEquationFn, RelativePlace};
///
/// // The second marker stays on a parabola in the x-z plane of the first, 4 z = x².
/// let equation = JointEquationFn::new("parabola", |RelativePlace { position, .. }: &RelativePlace| EquationValue {
///     residual: position.z - position.x * position.x / 4.0,
///     by_position: Vector3::new(-position.x / 2.0, 0.0, 1.0),
///     by_turn: Vector3::zeros(),
/// });
/// ```
pub struct JointEquationFn<F> {
    name: String,
    equation: F,
}

impl<F: Fn(&RelativePlace) -> EquationValue + Send + Sync> JointEquationFn<F> {
    /// An equation with a name for messages.
    pub fn new(name: impl Into<String>, equation: F) -> Self {
        Self { name: name.into(), equation }
    }
}

impl<F: Fn(&RelativePlace) -> EquationValue + Send + Sync> JointEquation for JointEquationFn<F> {
    fn value(&self, place: &RelativePlace) -> EquationValue {
        (self.equation)(place)
    }
}

impl<F> fmt::Debug for JointEquationFn<F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("JointEquationFn").field("name", &self.name).finish_non_exhaustive()
    }
}

impl RelativePlace {
    fn between([i, j]: [Frame; 2]) -> Self {
        Self { position: i.1.tr_mul(&(j.0 - i.0)), axes: i.1.tr_mul(&j.1) }
    }
}

/// Position and axes of a marker, global.
pub(crate) type Frame = (Vector3<f64>, Matrix3<f64>);

/// The wrenches of an equation. With d from i to j in the axes of i, the rate of g(d, R) is ∂g/∂d·(ḋ − ω_i×d) + ∂g/∂φ·(ω_j − ω_i).
pub(crate) fn wrench(equation: &dyn JointEquation, places: [&MarkerPlace; 2]) -> RowWrench {
    wrench_between(equation, places.map(frame))
}

/// The derivatives of an equation that are farthest from its differences, and these; `None` where all fit.
pub(crate) fn misfit(equation: &dyn JointEquation, places: [&MarkerPlace; 2]) -> Option<[f64; 2]> {
    let at = RelativePlace::between(places.map(frame));
    let length = length_of(&at.position);
    let found = equation.value(&at);
    let slope = |by: f64, moved: &dyn Fn(f64) -> RelativePlace| {
        let [after, before] = [by, -by].map(|by| equation.value(&moved(by)).residual);
        (after - before) / (2.0 * by)
    };
    let pair = |k: usize| {
        let axis = Vector3::ith(k % 3, 1.0);
        if k < 3 {
            let moved = |by: f64| RelativePlace { position: at.position + axis * by, ..at };
            [found.by_position[k] * length, slope(DIFFERENCE * length, &moved) * length]
        } else {
            let turned = |by: f64| RelativePlace { axes: transformation_matrix(&(axis * -by)) * at.axes, ..at };
            [found.by_turn[k - 3], slope(DIFFERENCE, &turned)]
        }
    };
    let pairs: [[f64; 2]; 6] = std::array::from_fn(pair);
    let off = |[stated, differences]: &[f64; 2]| (stated - differences).abs();
    let scale = pairs.iter().flatten().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    let fits = |pair: &[f64; 2]| off(pair) <= FITS * scale;
    pairs.into_iter().filter(|pair| !fits(pair)).max_by(|a, b| off(a).total_cmp(&off(b)))
}

/// Part of the largest derivative by which one may differ from its difference.
const FITS: f64 = 1e-4;

/// Differences of places, relative to the distance of the markers, and of angles.
pub(crate) const DIFFERENCE: f64 = 1e-4;

/// The scale of differences of positions.
pub(crate) fn length_of(arm: &Vector3<f64>) -> f64 {
    if arm.norm() > 0.0 { arm.norm() } else { 1.0 }
}

pub(crate) fn frame(place: &MarkerPlace) -> Frame {
    (place.position, place.axes)
}

/// The wrenches of an equation between two frames.
pub(crate) fn wrench_between(equation: &dyn JointEquation, [i, j]: [Frame; 2]) -> RowWrench {
    let arm = j.0 - i.0;
    let EquationValue { residual, by_position, by_turn } = equation.value(&RelativePlace::between([i, j]));
    let [force, moment] = [by_position, by_turn].map(|vector| i.1 * vector);
    RowWrench { residual, own_rate: 0.0, force, moments: [force.cross(&arm) - moment, moment] }
}
