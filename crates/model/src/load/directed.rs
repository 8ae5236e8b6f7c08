//! The stress stiffness of a load in a direction.

use faer::Mat;
use nalgebra::Vector3;

/// A force or moment in body axes, where the history of the load is 1, and the stiffness by its stress. A field of forces
/// has no direction.
pub(crate) struct Directed {
    pub vector: Vector3<f64>,
    pub stiffness: Mat<f64>,
}
