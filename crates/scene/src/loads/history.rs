//! How loads and motions go with time.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A factor on an amplitude over time, chosen by its key `kind`: the name of the variant.
pub type History = dynamics::History<TablePoints, Formula>;

/// A velocity given over time: radians per time of a hinge, length per time of a slider.
pub type DrivenSpeed = dynamics::DrivenSpeed<TablePoints, Formula>;

/// A table: straight lines or cubics between points, the first and the last value held before and after them.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TablePoints {
    /// Pairs of time and factor, at least two, the times rising: those in the scene, or those read from the file.
    #[serde(default)]
    pub points: Vec<[f64; 2]>,
    /// A CSV file of the points; a path in a scene is relative to the scene file.
    pub file: Option<PathBuf>,
    /// The way from point to point; default straight lines.
    #[serde(default)]
    pub interpolation: Interpolation,
}

/// How a table goes from point to point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Interpolation {
    /// Straight lines: the rate jumps at each point.
    #[default]
    Linear,
    /// Cubics whose rate does not jump, and which rise and fall only where the points do.
    MonotoneCubic,
}

impl Interpolation {
    /// The way in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Linear => "straight lines",
            Self::MonotoneCubic => "monotone cubics",
        }
    }
}

/// A formula in the time `t`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Formula {
    /// The formula in t.
    pub formula: String,
    /// Rising times at which the formula or its rates jump; default none.
    #[serde(default, alias = "corners")] // scenes of version 0.1 say "corners"
    pub discontinuities: Vec<f64>,
}
