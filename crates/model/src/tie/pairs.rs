//! Pairs of places of the two ends of a joint.

use nalgebra::{Matrix3, Vector3};

use dynamics::Marker;

use crate::tie::ends::EndAtStart;

/// Largest distance of two places of a pair, over the size of the end.
const APART: f64 = 1e-2;

/// Reason that the places of two ends are not pairs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Unpaired {
    /// The ends have different numbers of places.
    Count([usize; 2]),
    /// The end of this number deforms, and is one place beside several.
    OnePlace(usize),
    /// Places of a pair are so far from each other, by the middles of the ends.
    Apart(f64),
}

/// Markers at the places of two ends, by pairs, with these axes of the ends; none where both ends are one place.
pub(crate) fn pairs(ends: &[EndAtStart<'_>; 2], axes: &[Matrix3<f64>; 2]) -> Result<Vec<[Marker; 2]>, Unpaired> {
    let places = ends.each_ref().map(EndAtStart::part_positions);
    let rigid = |end: usize, at: &[Vector3<f64>]| -> Result<Vec<Marker>, Unpaired> {
        at.iter().map(|at| ends[end].rigid_marker(*at, axes[end]).ok_or(Unpaired::OnePlace(end))).collect()
    };
    let part = |end: usize, part: usize| ends[end].part_marker(part, axes[end]);
    let all = |end: usize| (0..places[end].len()).filter_map(move |number| part(end, number));
    match places.each_ref().map(Vec::len) {
        [0, 0] => Ok(Vec::new()),
        [0, _] => Ok(rigid(0, &places[1])?.into_iter().zip(all(1)).map(<[Marker; 2]>::from).collect()),
        [_, 0] => Ok(all(0).zip(rigid(1, &places[0])?).map(<[Marker; 2]>::from).collect()),
        [first, second] if first != second => Err(Unpaired::Count([first, second])),
        _ => {
            let order = nearest(&places)?;
            Ok(all(0).zip(order.iter().filter_map(|number| part(1, *number))).map(<[Marker; 2]>::from).collect())
        }
    }
}

/// The place of the second end that is the nearest to each of the first, both seen from their middles.
fn nearest([first, second]: &[Vec<Vector3<f64>>; 2]) -> Result<Vec<usize>, Unpaired> {
    let middle = |places: &[Vector3<f64>]| places.iter().sum::<Vector3<f64>>() / places.len() as f64;
    let between = middle(second) - middle(first);
    let size = first.iter().map(|x| (x - middle(first)).norm()).fold(0.0, f64::max);
    let mut is_taken = vec![false; second.len()];
    let mut next = |x: &Vector3<f64>| {
        let distance = |number: &usize| (second[*number] - x - between).norm();
        let free = (0..second.len()).filter(|number| !is_taken[*number]);
        let number = free.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or_default();
        is_taken[number] = true;
        match distance(&number) <= APART * size {
            true => Ok(number),
            false => Err(Unpaired::Apart(distance(&number))),
        }
    };
    first.iter().map(&mut next).collect()
}
