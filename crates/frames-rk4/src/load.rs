//! Forces on points of the body.

use nalgebra::Vector3;

use crate::history::History;
use crate::motion::PointShapes;

/// A force that keeps its global direction, at a point of the body.
#[derive(Debug, Clone)]
pub struct DeadForce {
    /// Where it acts.
    pub point: PointShapes,
    /// Direction times amplitude, global components.
    pub force_global: Vector3<f64>,
    /// Its course in time.
    pub history: History,
}
