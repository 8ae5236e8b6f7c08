//! A moment at a place of the body.

use keys::Key;
use nalgebra::Vector3;

use super::{Applied, Kinematics, Load, LoadFrame, Pattern, check_vector};
use crate::body::second_order::SecondOrder;
use crate::body::shapes::RotationShapes;
use crate::error::SetupError;
use crate::history::History;

/// A moment.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub struct PointMoment {
    /// How the place where it acts is turned by the modes.
    pub rotation: RotationShapes,
    /// Moment where the history is 1, components in the axes of `frame`.
    pub moment: Vector3<f64>,
    /// Its axes.
    pub frame: LoadFrame,
    /// The factor on it.
    pub history: History,
}

impl Load for PointMoment {
    fn apply(&self, motion: &Kinematics, applied: &mut Applied) {
        applied.moment(&self.rotation, &(motion.to_body(&self.moment, self.frame) * motion.factor(&self.history)));
    }

    fn history(&self) -> Option<&History> {
        Some(&self.history)
    }

    fn key(&self, key: Key) -> Key {
        let Self { rotation, moment, frame, history } = self;
        let key = key.of("point moment", 1).with("rotation", rotation).with("moment", moment);
        key.with("frame", frame).with("history", history)
    }

    fn is_same(&self, time: f64, branch_times: [f64; 2]) -> bool {
        self.history.is_same(time, branch_times)
    }

    fn pattern(&self) -> Option<Pattern> {
        let columns = self.rotation.columns().to_vec();
        Some(Pattern { columns, vector: self.moment, frame: self.frame, local: true })
    }

    fn matrix_entries(&self) -> usize {
        self.rotation.second_order().map_or(0, SecondOrder::entries)
    }

    fn check(&self, flexible: usize) -> Result<(), SetupError> {
        self.history.check()?;
        check_vector("a moment", &self.moment, self.rotation.flexible(), self.rotation.second_order(), flexible)
    }
}
