//! Directions.

use nalgebra::Vector3;

/// The vector with length 1, of any finite length but 0 (scaled first, so that neither huge nor
/// tiny components are lost in their squares).
pub(crate) fn unit(vector: &Vector3<f64>) -> Option<Vector3<f64>> {
    let largest = vector.amax();
    (largest > 0.0).then(|| (vector / largest).normalize())
}
