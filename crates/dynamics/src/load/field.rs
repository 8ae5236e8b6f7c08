//! Forces on many nodes that are fixed in body axes, such as a pressure.

use keys::Key;
use nalgebra::Vector3;

use super::{Applied, BodyField, Kinematics, Load, LoadFrame, Pattern, check_vector};
use crate::error::SetupError;
use crate::history::History;

/// A field of forces times a history.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub struct FieldLoad {
    /// The forces where the history is 1.
    pub field: BodyField,
    /// The factor on them.
    pub history: History,
}

impl Load for FieldLoad {
    fn apply(&self, motion: &Kinematics, applied: &mut Applied) {
        applied.field(&self.field, motion.factor(&self.history));
    }

    fn history(&self) -> Option<&History> {
        Some(&self.history)
    }

    fn key(&self, key: Key) -> Key {
        key.of("field load", 1).with("field", &self.field).with("history", &self.history)
    }

    fn is_same(&self, time: f64, branch_times: [f64; 2]) -> bool {
        self.history.is_same(time, branch_times)
    }

    fn pattern(&self) -> Option<Pattern> {
        let columns = self.field.modal.iter().map(|f| Vector3::x() * *f).collect();
        Some(Pattern { columns, vector: Vector3::x(), frame: LoadFrame::Body, local: false })
    }

    fn check(&self, flexible: usize) -> Result<(), SetupError> {
        self.history.check()?;
        let BodyField { force_body, moment_body, modal, force_change, moment_change, load_stiffness, second_order } =
            &self.field;
        let modes = moment_change.len().min(modal.len().saturating_sub(6));
        for (what, found, expected) in [
            ("the changes of the resultant of a field of forces", force_change.len(), modes),
            ("the load stiffness of a field of forces", load_stiffness.len(), modes * modes),
        ] {
            if found != 0 && found != expected {
                return Err(SetupError::Entries { what, found, expected: expected.to_string() });
            }
        }
        let vectors = force_change.iter().chain(moment_change).chain([moment_body]).flat_map(|vector| vector.iter());
        if let Some(found) = vectors.chain(modal).chain(load_stiffness).copied().find(|f| !f.is_finite()) {
            return Err(SetupError::Value { what: "a field of forces", found, expected: "a finite number" });
        }
        check_vector("a field of forces", force_body, modes, second_order.as_ref(), flexible)
    }

    fn matrix_entries(&self) -> usize {
        self.field.load_stiffness.len() + self.field.second_order.as_ref().map_or(0, |k| k.entries())
    }
}
