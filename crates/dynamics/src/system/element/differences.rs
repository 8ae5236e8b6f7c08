//! The directions in which a law from outside is stiff, by differences of its wrenches, for Newton's method.

use nalgebra::{SMatrix, SVector, Vector3};

use crate::system::marker::Marker;
use crate::system::marker::motion::{MarkerChange, MarkerMotion, MarkerWrench};

/// Markers of a law whose directions are found, and directions of each: a force and a moment along three axes.
const MARKERS: usize = 2;
const OF_MARKER: usize = 6;
const ALL: usize = MARKERS * OF_MARKER;
/// Differences of places and velocities, relative to the distance of the markers and to their speed, or to 1; and over places, where
/// these are far from the origin.
pub(super) const DIFFERENCE: f64 = 1e-6;
const OF_PLACE: f64 = 1e-12;
/// A stiffness over the largest that is rounding of the differences.
const ROUNDING: f64 = 1e-9;

type Square = SMatrix<f64, ALL, ALL>;
type Column = SVector<f64, ALL>;

/// A difference of a quantity of this size, and of an angle or an angular velocity, whose size is zero.
pub(super) fn difference(size: f64) -> f64 {
    DIFFERENCE * size.max(1.0)
}

/// Number of directions of a law at these markers: six for each on a body, none of a law at more than two markers.
pub(super) fn directions(markers: &[Marker]) -> usize {
    let on_bodies = markers.iter().filter(|marker| marker.body().is_some()).count();
    if markers.len() > MARKERS { 0 } else { OF_MARKER * on_bodies }
}

/// Calls `set` for the directions of a law at markers with these motions: the eigenvectors of the symmetric part of how its wrenches fall
/// with the places and with the velocities of its markers. One more call of the law than there are columns.
pub(super) fn linearize(
    markers: &[Marker],
    motions: &[MarkerMotion],
    apply: impl Fn(&[MarkerMotion], &mut [MarkerWrench]),
    mut set: impl FnMut(usize, [f64; 2], &[MarkerWrench]),
) {
    let (Some(first), Some(last)) = (motions.first(), motions.last()) else { return };
    let (count, known) = (motions.len(), directions(markers));
    if known == 0 {
        return;
    }
    let at = |moved: &[MarkerMotion]| -> Column {
        let mut wrenches = [MarkerWrench::default(); MARKERS];
        apply(moved, &mut wrenches[..count]);
        let [i, j] = wrenches.map(|wrench| [wrench.force_global, wrench.moment_global]);
        Column::from_iterator([i, j].iter().flatten().flat_map(|vector| vector.iter().copied()))
    };
    let here = at(motions);
    let [length, speed] = [first.position_global - last.position_global, last.velocity_global].map(|line| line.norm());
    let mut falls = [Square::zeros(); 2];
    for (which, fall) in falls.iter_mut().enumerate() {
        let on_bodies = markers.iter().enumerate().filter(|(_, marker)| marker.body().is_some());
        for (k, axis) in on_bodies.flat_map(|(k, _)| (0..OF_MARKER).map(move |axis| (k, axis))) {
            let unit = Vector3::ith(axis % 3, 1.0);
            let place = OF_PLACE * motions[k].position_global.norm();
            let (change, size) = match (which, axis < 3) {
                (0, true) => (MarkerChange { displacement_global: unit, ..MarkerChange::default() }, length),
                (0, false) => (MarkerChange { turn_global: unit, ..MarkerChange::default() }, 0.0),
                (_, true) => (MarkerChange { velocity_global: unit, ..MarkerChange::default() }, speed),
                (_, false) => (MarkerChange { omega_global: unit, ..MarkerChange::default() }, 0.0),
            };
            let small = difference(size).max(place);
            let mut moved = [*first, *last];
            moved[k] = motions[k].changed(&change, small);
            fall.set_column(k * OF_MARKER + axis, &((here - at(&moved[..count])) / small));
        }
        // Of markers on the ground there is no column, and so no row.
        for (k, marker) in markers.iter().enumerate() {
            if marker.body().is_none() {
                fall.fixed_rows_mut::<OF_MARKER>(k * OF_MARKER).fill(0.0);
            }
        }
        *fall = 0.5 * (*fall + fall.transpose());
    }
    let sizes = falls.each_ref().map(Square::norm);
    // Not so of a law that gives no numbers, which is found where it is applied.
    if !sizes.iter().all(|size| size.is_finite()) || sizes == [0.0; 2] {
        let none = [MarkerWrench::default(); MARKERS];
        return (0..known).for_each(|number| set(number, [0.0; 2], &none[..count]));
    }
    let part = |which: usize| if sizes[which] > 0.0 { falls[which] / sizes[which] } else { Square::zeros() };
    let eigen = (part(0) + part(1)).symmetric_eigen();
    let mut order: [usize; ALL] = std::array::from_fn(|k| k);
    order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
    for (number, k) in order.into_iter().take(known).enumerate() {
        let along: Column = eigen.eigenvectors.column(k).into();
        let of = |which: usize| {
            let fall = along.dot(&(falls[which] * along));
            if fall > ROUNDING * sizes[which] { fall } else { 0.0 }
        };
        let wrench = |marker: usize| MarkerWrench {
            force_global: along.fixed_rows::<3>(marker * OF_MARKER).into(),
            moment_global: along.fixed_rows::<3>(marker * OF_MARKER + 3).into(),
        };
        set(number, [of(0), of(1)], &[wrench(0), wrench(1)][..count]);
    }
}
