//! A force at a point.

use keys::Key;
use nalgebra::Vector3;

use super::{Applied, Kinematics, Load, LoadFrame, Pattern, check_vector};
use crate::body::second_order::SecondOrder;
use crate::body::shapes::{PointShapes, RotationShapes};
use crate::error::SetupError;
use crate::history::History;

/// A force at a point. A load of one direction that is spread over the body, such as a traction or gravity, is its
/// resultant at the point that moves as the weighted mean of where it acts.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub struct PointForce {
    /// Where it acts.
    pub point: PointShapes,
    /// Force where the history is 1, components in the axes of `frame`.
    pub force: Vector3<f64>,
    /// Its axes.
    pub frame: LoadFrame,
    /// How the material that a force in [`LoadFrame::Material`] turns with is turned by the modes; without it the force turns
    /// with the body.
    pub turning: Option<RotationShapes>,
    /// The factor on it.
    pub history: History,
}

impl PointForce {
    /// A force that keeps its global direction.
    pub fn dead(point: PointShapes, force: Vector3<f64>, history: History) -> Self {
        Self { point, force, frame: LoadFrame::Global, turning: None, history }
    }
}

impl Load for PointForce {
    fn apply(&self, motion: &Kinematics, applied: &mut Applied) {
        let force_body = match &self.turning {
            Some(place) if self.frame == LoadFrame::Material => motion.turned(place, &self.force),
            _ => motion.to_body(&self.force, self.frame),
        };
        applied.force(&self.point, &(force_body * motion.factor(&self.history)));
    }

    fn history(&self) -> Option<&History> {
        Some(&self.history)
    }

    fn key(&self, key: Key) -> Key {
        let Self { point, force, frame, turning, history } = self;
        let key = key.of("point force", 1).with("point", point).with("force", force).with("frame", frame);
        key.with("turning", turning).with("history", history)
    }

    fn is_same(&self, time: f64, branch_times: [f64; 2]) -> bool {
        self.history.is_same(time, branch_times)
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
        if let Some(found) = self.turning.as_ref().map(RotationShapes::flexible).filter(|found| *found < flexible) {
            return Err(SetupError::Length { what: "the turning of a force", expected: flexible, found });
        }
        check_vector("a force", &self.force, self.point.flexible(), self.point.second_order(), flexible)
    }
}
