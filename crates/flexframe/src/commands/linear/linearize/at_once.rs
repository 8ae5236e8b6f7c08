//! Rank of D, where outputs are as many as inputs: it tells if each combination of inputs is seen at once.

use faer::Mat;
use linear::{Channel, SecondOrder, StateSpace};
use serde::Serialize;

/// A singular value below this part of the largest is none: rows and columns are in the scale of their largest entries.
const NONE: f64 = 1e-9;
/// A row or a column below this part of the largest of its unit is rounding.
const ROUNDING: f64 = 1e-12;
/// Passes in which rows and columns come to one scale.
const PASSES: usize = 4;
/// A channel with less than this part of the largest share of a combination is not named.
const SHARE: f64 = 0.01;

/// Rank of a square D: of what the outputs see of the inputs at once, without a state in between.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AtOnce {
    /// Rank of D.
    pub rank: usize,
    /// Number of inputs, which is that of outputs.
    pub of: usize,
    /// Least singular value over the largest, with rows and columns in the scale of their largest entries; 0 where D is zero.
    pub least: f64,
    /// Inputs of which combinations are not seen at once.
    pub inputs: Vec<String>,
    /// Outputs of which combinations see nothing at once.
    pub outputs: Vec<String>,
}

impl AtOnce {
    /// Rank of a state space; `None` where there are more outputs than inputs, or fewer.
    pub(super) fn of(space: &StateSpace) -> Option<Self> {
        let size = space.inputs.len();
        if size == 0 || space.outputs.len() != size {
            return None;
        }
        let d = scaled(&without_rounding(&space.d, &space.outputs, &space.inputs));
        let svd = d.svd().ok()?;
        let values: Vec<f64> = svd.S().column_vector().iter().copied().collect();
        let largest = values.first().copied().unwrap_or_default();
        let rank = values.iter().filter(|value| **value > NONE * largest).count();
        let named = |vectors: faer::MatRef<'_, f64>, channels: &[Channel]| {
            let share = |i: usize| (rank..size).map(|k| vectors[(i, k)].abs()).fold(0.0, f64::max);
            let most = (0..size).map(share).fold(0.0, f64::max);
            let of = (0..size).filter(|i| rank < size && share(*i) > SHARE * most);
            of.map(|i| channels[i].name.clone()).collect::<Vec<_>>()
        };
        Some(Self {
            rank,
            of: size,
            least: if largest > 0.0 { values[size - 1] / largest } else { 0.0 },
            inputs: named(svd.V(), &space.inputs),
            outputs: named(svd.U(), &space.outputs),
        })
    }

    /// Rank of equations of second order.
    pub(in crate::commands::linear) fn of_equations(equations: &SecondOrder) -> Option<Self> {
        Self::of(&equations.state_space().ok()?)
    }

    /// A sentence about D where it is singular.
    pub(in crate::commands::linear) fn in_words(&self) -> Option<String> {
        let Self { rank, of, inputs, outputs, .. } = self;
        if rank == of {
            return None;
        }
        if *rank == 0 {
            return Some(
                "zero: no output sees an input at once, only as the motion goes on; the model has no inverse that is proper"
                    .into(),
            );
        }
        Some(format!(
            "singular, of rank {rank} of {of}: the outputs do not see combinations of the inputs {} at once, and combinations of the outputs {} \
             see no input; the model has no inverse that is proper, and a loop that is closed through the inverse of D does not exist",
            inputs.join(", "),
            outputs.join(", ")
        ))
    }
}

/// D without what is rounding beside the largest entry that its output's unit has by its input's unit.
fn without_rounding(d: &Mat<f64>, outputs: &[Channel], inputs: &[Channel]) -> Mat<f64> {
    let largest = |i: usize, j: usize| {
        let alike = (0..d.nrows()).flat_map(|k| (0..d.ncols()).map(move |l| (k, l)));
        let alike = alike.filter(|(k, l)| outputs[*k].unit == outputs[i].unit && inputs[*l].unit == inputs[j].unit);
        alike.map(|(k, l)| d[(k, l)].abs()).fold(0.0, f64::max)
    };
    Mat::from_fn(d.nrows(), d.ncols(), |i, j| if d[(i, j)].abs() > ROUNDING * largest(i, j) { d[(i, j)] } else { 0.0 })
}

/// The matrix with its rows and columns in one scale, so that units do not count.
fn scaled(of: &Mat<f64>) -> Mat<f64> {
    let mut d = of.clone();
    for _ in 0..PASSES {
        for i in 0..d.nrows() {
            let size = (0..d.ncols()).map(|j| d[(i, j)].abs()).fold(0.0, f64::max);
            (0..d.ncols()).filter(|_| size > 0.0).for_each(|j| d[(i, j)] /= size);
        }
        for j in 0..d.ncols() {
            let size = (0..d.nrows()).map(|i| d[(i, j)].abs()).fold(0.0, f64::max);
            (0..d.nrows()).filter(|_| size > 0.0).for_each(|i| d[(i, j)] /= size);
        }
    }
    d
}

#[cfg(test)]
mod tests {
    use super::*;

    fn space(d: &[&[f64]], units: [&[&str]; 2]) -> StateSpace {
        let [outputs, inputs] = [("y", units[0]), ("u", units[1])].map(|(name, units)| {
            let channel = |(k, unit): (usize, &&str)| Channel::new(format!("{name}{k}"), *unit);
            units.iter().enumerate().map(channel).collect::<Vec<_>>()
        });
        StateSpace {
            a: Mat::new(),
            b: Mat::zeros(0, inputs.len()),
            c: Mat::zeros(outputs.len(), 0),
            d: Mat::from_fn(outputs.len(), inputs.len(), |i, j| d[i][j]),
            states: Vec::new(),
            inputs,
            outputs,
        }
    }

    /// Closed form: the rank of matrices with known ones, whatever the units.
    #[test]
    fn the_rank_does_not_depend_on_units() {
        let units: [&[&str]; 2] = [&["m/s²", "m/s²"], &["N", "N m"]];
        for scale in [1.0, 1e-12, 1e9] {
            let regular = AtOnce::of(&space(&[&[2.0, scale], &[1.0, 3.0 * scale]], units)).unwrap();
            assert!((regular.rank, regular.of) == (2, 2) && regular.least > 0.1, "{regular:?}");
            assert!(regular.in_words().is_none() && regular.inputs.is_empty());
            let singular = AtOnce::of(&space(&[&[2.0, 3.0 * scale], &[1.0, 1.5 * scale]], units)).unwrap();
            assert!(singular.rank == 1 && singular.least < 1e-15, "{singular:?}");
            let said = singular.in_words().unwrap();
            assert!(said.contains("of rank 1 of 2") && said.contains("u0, u1") && said.contains("y0, y1"), "{said}");
        }
    }

    #[test]
    fn channels_that_are_not_seen_are_named_and_rounding_is_nothing() {
        let units: [&[&str]; 2] = [&["m", "m/s²", "m/s²"], &["N", "N", "N"]];
        let rows: [&[f64]; 3] = [&[0.0; 3], &[1.0, 2.0, 1e-17], &[3.0, 1.0, -1e-16]];
        let found = AtOnce::of(&space(&rows, units)).unwrap();
        assert_eq!((found.rank, &found.inputs[..], &found.outputs[..]), (2, &["u2".into()][..], &["y0".into()][..]));
        let zero = AtOnce::of(&space(&[&[0.0]], [&["m"], &["N"]])).unwrap();
        assert!(zero.rank == 0 && zero.in_words().unwrap().starts_with("zero"));
        assert_eq!(AtOnce::of(&space(&[&[1.0, 2.0]], [&["m"], &["N", "N"]])), None);
    }
}
