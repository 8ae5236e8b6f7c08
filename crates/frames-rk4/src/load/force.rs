//! A force at a point.

use nalgebra::Vector3;

use super::{Applied, Kinematics, Load, LoadFrame, Pattern, check_vector};
use crate::error::SetupError;
use crate::history::History;
use crate::motion::PointShapes;
use crate::second_order::SecondOrder;

/// A force at a point. A load of one direction that is spread over the body, such as a traction or gravity, is its
/// resultant at the point that moves as the weighted mean of where it acts.
#[derive(Debug, Clone)]
pub struct PointForce {
    /// Where it acts.
    pub point: PointShapes,
    /// Force where the history is 1, components in the axes of `frame`.
    pub force: Vector3<f64>,
    /// Its axes.
    pub frame: LoadFrame,
    /// The factor on it.
    pub history: History,
}

impl PointForce {
    /// A force that keeps its global direction.
    pub fn dead(point: PointShapes, force: Vector3<f64>, history: History) -> Self {
        Self { point, force, frame: LoadFrame::Global, history }
    }
}

impl Load for PointForce {
    fn apply(&self, motion: &Kinematics, applied: &mut Applied) {
        applied.force(&self.point, &(motion.to_body(&self.force, self.frame) * motion.factor(&self.history)));
    }

    fn history(&self) -> Option<&History> {
        Some(&self.history)
    }

    fn pattern(&self) -> Option<Pattern> {
        let columns = self.point.columns().to_vec();
        Some(Pattern { columns, vector: self.force, frame: self.frame, local: true })
    }

    fn matrix_entries(&self) -> usize {
        self.point.second_order().map_or(0, SecondOrder::entries)
    }

    fn check(&self, flexible: usize) -> Result<(), SetupError> {
        self.history.check()?;
        check_vector("a force", &self.force, self.point.flexible(), self.point.second_order(), flexible)
    }
}
