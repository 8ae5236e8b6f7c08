//! Step or tolerance of a run.

use std::fmt;

use dynamics::StepControl;
use serde::Serialize;

/// Step or tolerance, as in the scene.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Setting {
    /// Length of a step.
    Step(f64),
    /// Tolerance of step control.
    Tolerance(f64),
}

impl Setting {
    /// The number.
    pub fn value(self) -> f64 {
        match self {
            Self::Step(value) | Self::Tolerance(value) => value,
        }
    }
}

impl From<StepControl> for Setting {
    fn from(control: StepControl) -> Self {
        match control {
            StepControl::Fixed(step) => Self::Step(step),
            StepControl::Tolerance(tolerance) => Self::Tolerance(tolerance),
        }
    }
}

/// The line of the scene file.
impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Step(step) => write!(f, "step = {step:e}"),
            Self::Tolerance(tolerance) => write!(f, "tolerance = {tolerance:e}"),
        }
    }
}
