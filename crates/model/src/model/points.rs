//! The points that a scene asks for, and those that are chosen where it names none.

use nalgebra::Vector3;
use scene::Body;

use crate::error::BuildError;

pub(crate) fn output_points<T>(
    body: &Body,
    point: impl Fn(String, [f64; 3]) -> Result<T, BuildError>,
) -> Result<Vec<(String, T)>, BuildError> {
    let named = body.output.points.iter();
    named.map(|(name, at)| Ok((name.clone(), point(format!("output.points.{name}"), *at)?))).collect()
}

/// Three nodes that lie far from each other: R farthest from the centre of mass, P farthest from R, Q farthest from
/// the line RP.
pub(crate) fn well_spread(positions: &[[f64; 3]], center_of_mass: &Vector3<f64>) -> [[f64; 3]; 3] {
    let farthest = |distance: &dyn Fn(&Vector3<f64>) -> f64| {
        positions.iter().map(|x| Vector3::from(*x)).fold((Vector3::zeros(), f64::NEG_INFINITY), |best, x| {
            let d = distance(&x);
            if d > best.1 { (x, d) } else { best }
        })
    };
    let (r, _) = farthest(&|x| (x - center_of_mass).norm());
    let (p, _) = farthest(&|x| (x - r).norm());
    let (q, _) = farthest(&|x| (x - r).cross(&(p - r)).norm());
    [r.into(), p.into(), q.into()]
}
