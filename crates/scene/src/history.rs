//! How loads and motions go with time.

use std::path::PathBuf;

use serde::Deserialize;

/// A factor on an amplitude over time, chosen by its key `kind`.
///
/// Frequencies are in cycles per time (hertz where the unit of time is the second), phases in radians.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum History {
    /// `kind = "constant"`: 1 at all times.
    #[default]
    Constant,
    /// `kind = "step"`: 0 before the time `at`, 1 from there on.
    Step {
        /// Time of the jump; one that is not positive has happened before the run.
        at: f64,
    },
    /// `kind = "ramp"`: 0 before the start, (t − start) / duration within the duration, 1 after it.
    Ramp {
        /// Time at which it begins; default 0.
        #[serde(default)]
        start: f64,
        /// Time > 0 from 0 to 1.
        duration: f64,
    },
    /// `kind = "half-sine"`: sin(π (t − start) / duration) while start ≤ t ≤ start + duration,
    /// otherwise 0.
    HalfSine {
        /// Time at which it begins; default 0. A negative one has begun before the run.
        #[serde(default)]
        start: f64,
        /// Length > 0 of the pulse in time.
        duration: f64,
    },
    /// `kind = "sine"`: sin(2π frequency (t − start) + phase) from the start for the duration, otherwise 0.
    Sine {
        /// Frequency > 0, cycles per time.
        frequency: f64,
        /// Phase at the start, radians; default 0.
        #[serde(default)]
        phase: f64,
        /// Time at which it begins; default 0.
        #[serde(default)]
        start: f64,
        /// Length > 0 in time; `None` is to the end of the run.
        duration: Option<f64>,
    },
    /// `kind = "sweep"`: a sine whose frequency goes from one value to another in proportion to time,
    /// sin(2π (from τ + (to − from) τ² / (2 duration))) with τ = t − start within the duration, otherwise 0.
    Sweep {
        /// Frequency ≥ 0 at the start, cycles per time.
        from: f64,
        /// Frequency ≥ 0 at the end, cycles per time.
        to: f64,
        /// Time at which it begins; default 0.
        #[serde(default)]
        start: f64,
        /// Length > 0 in time.
        duration: f64,
    },
    /// `kind = "table"`: straight lines between points, the first and the last value held before and after them.
    Table(Table),
    /// `kind = "expression"`: a formula in the time `t`.
    Expression {
        /// The formula as it is written; not empty, and not looked at any further here.
        formula: String,
        /// Rising times at which the formula or its rates jump; default none.
        #[serde(default)]
        corners: Vec<f64>,
    },
    /// `kind = "product"`: the product of other histories.
    Product {
        /// The factors, at least one.
        factors: Vec<History>,
    },
}

/// A history given by points.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Table {
    /// Pairs of time and factor, at least one, the times rising: those in the scene, or those read from the file.
    #[serde(default)]
    pub points: Vec<[f64; 2]>,
    /// The CSV file that the points come from, already resolved against the folder of the scene file;
    /// `None` if they stand in the scene.
    pub file: Option<PathBuf>,
}
