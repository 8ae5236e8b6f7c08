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
    pub(crate) fn between([i, j]: [&MarkerPlace; 2]) -> Self {
        Self { position: i.axes.tr_mul(&(j.position - i.position)), axes: i.axes.tr_mul(&j.axes) }
    }

    /// The place after a displacement and a turn of the second marker.
    fn moved(&self, displacement: &Vector3<f64>, turn: &Vector3<f64>) -> Self {
        Self { position: self.position + displacement, axes: transformation_matrix(&-turn) * self.axes }
    }
}

/// The wrenches of an equation. With d from i to j in the axes of i, the rate of g(d, R) is ∂g/∂d·(ḋ − ω_i×d) + ∂g/∂φ·(ω_j − ω_i).
pub(crate) fn wrench(equation: &dyn JointEquation, [i, j]: [&MarkerPlace; 2]) -> RowWrench {
    let EquationValue { residual, by_position, by_turn } = equation.value(&RelativePlace::between([i, j]));
    let [force, moment] = [by_position, by_turn].map(|vector| i.axes * vector);
    let arm = j.position - i.position;
    RowWrench { residual, own_rate: 0.0, force, moments: [force.cross(&arm) - moment, moment] }
}

/// How the derivatives of an equation change by a small displacement and a small turn of the second marker as the first sees it: by
/// differences of fourth order. `length` is that of the bodies.
pub(crate) fn derivative_changes(
    equation: &dyn JointEquation,
    place: &RelativePlace,
    [displacement, turn]: [&Vector3<f64>; 2],
    length: f64,
) -> [Vector3<f64>; 2] {
    let size = (displacement.norm() / scale(place, length)).max(turn.norm());
    if size == 0.0 {
        return [Vector3::zeros(); 2];
    }
    let step = FOURTH_ORDER / size;
    let at = |factor: f64| equation.value(&place.moved(&(displacement * factor), &(turn * factor)));
    let [near, far] = [step, 2.0 * step].map(|by| [at(by), at(-by)]);
    [|value: &EquationValue| value.by_position, |value: &EquationValue| value.by_turn].map(|of| {
        let [near, far] = [&near, &far].map(|[after, before]| of(after) - of(before));
        (near * 8.0 - far) / (12.0 * step)
    })
}

/// Steps of differences of first derivatives, and of second ones by first ones, relative to a length or in rad: where truncation and
/// rounding are small.
const SECOND_ORDER: f64 = 1e-5;
const FOURTH_ORDER: f64 = 1e-4;
/// Part of the largest derivative by which one may differ from its difference.
const FITS: f64 = 1e-4;

/// The length of differences of positions. Far from the first marker, it is not below their rounding.
fn scale(place: &RelativePlace, length: f64) -> f64 {
    length.max(1e-3 * place.position.norm())
}

/// A derivative of an equation that is not its own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Misfit {
    /// By its name: what is stated, and what differences give.
    Differs { name: &'static str, stated: f64, difference: f64 },
    /// All are zero.
    Nothing,
}

/// The derivative that is farthest from its difference; `None` where all fit. `length` is that of the bodies.
pub(crate) fn misfit(equation: &dyn JointEquation, places: [&MarkerPlace; 2], length: f64) -> Option<Misfit> {
    const NAMES: [&str; 6] = ["by_position.x", "by_position.y", "by_position.z", "by_turn.x", "by_turn.y", "by_turn.z"];
    let place = RelativePlace::between(places);
    let length = scale(&place, length);
    let found = equation.value(&place);
    let pairs: [[f64; 2]; 6] = std::array::from_fn(|k| {
        let axis = Vector3::ith(k % 3, 1.0);
        let (stated, step) =
            if k < 3 { (found.by_position[k], SECOND_ORDER * length) } else { (found.by_turn[k - 3], SECOND_ORDER) };
        let [after, before] = [step, -step].map(|by| {
            let [moved, turned] = if k < 3 { [axis * by, Vector3::zeros()] } else { [Vector3::zeros(), axis * by] };
            equation.value(&place.moved(&moved, &turned)).residual
        });
        [stated, (after - before) / (2.0 * step)]
    });
    let weight = |k: usize| if k < 3 { length } else { 1.0 };
    let off = |k: &usize| weight(*k) * (pairs[*k][0] - pairs[*k][1]).abs();
    let largest = |of: usize| (0..6).map(|k| weight(k) * pairs[k][of].abs()).fold(0.0, f64::max);
    if largest(0) == 0.0 && largest(1) <= FITS * length {
        return Some(Misfit::Nothing);
    }
    let fits = |k: &usize| off(k) <= FITS * largest(0).max(largest(1));
    let worst = (0..6).filter(|k| !fits(k)).max_by(|a, b| off(a).total_cmp(&off(b)))?;
    let [stated, difference] = pairs[worst];
    Some(Misfit::Differs { name: NAMES[worst], stated, difference })
}
