//! The axes of the two ends of a joint, from what the scene says of them.

use nalgebra::{Matrix3, Vector3};

use crate::tie::body_marker::perpendicular;
use crate::tie::ends::EndAtStart;

/// Sine of the angle between two axes below which they have one direction.
const PARALLEL: f64 = 1e-6;

/// Axes of both ends as columns, global at the start.
///
/// An end has its own z, or that of the joint, or that of the other end; where nobody names one, that of the first body. Its x is
/// its own, or the nearest to that of the other end: the joint is then not turned at the start.
pub(crate) fn axes(ends: &[EndAtStart<'_>; 2], axis: Option<Vector3<f64>>) -> [Matrix3<f64>; 2] {
    let [own, other] = [&ends[0].own_axes, &ends[1].own_axes];
    let body = ends.iter().find(|end| end.is_on_body()).map_or_else(Matrix3::identity, |end| end.carrier_axes);
    let named = |own: &Option<(Vector3<f64>, Option<Vector3<f64>>)>| own.map(|(z, _)| z);
    let is_named = axis.is_some() || own.is_some() || other.is_some();
    let z_of = |own, other| named(own).or(axis).or(named(other)).unwrap_or_else(|| body.column(2).into());
    let [first, second] = [z_of(own, other), z_of(other, own)];
    let x_of = |own: &Option<(Vector3<f64>, Option<Vector3<f64>>)>| own.and_then(|(_, x)| x);
    let common = || if is_named { perpendicular(&first) } else { body.column(0).into() };
    let x = x_of(own).or(x_of(other)).unwrap_or_else(common);
    [(first, x_of(own)), (second, x_of(other))].map(|(z, own)| {
        let x = own.unwrap_or_else(|| nearest(&x, &z));
        Matrix3::from_columns(&[x, z.cross(&x), z])
    })
}

/// The unit vector at right angles to z that is the nearest to another.
fn nearest(x: &Vector3<f64>, z: &Vector3<f64>) -> Vector3<f64> {
    (x - z * z.dot(x)).try_normalize(PARALLEL).unwrap_or_else(|| perpendicular(z))
}
