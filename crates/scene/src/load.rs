//! The loads of a scene: what acts, where, and when.

use serde::Deserialize;

/// One `[[loads]]` entry, chosen by its key `kind`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Load {
    /// `kind = "force"`: a force at a point.
    Force(Force),
}

/// A force at a point of the body.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Force {
    /// Where it acts, length, mesh axes.
    pub at: [f64; 3],
    /// Unit vector of its direction, in the axes named by [`Force::frame`]. The file may give a
    /// vector of any length but 0.
    pub direction: [f64; 3],
    /// Force where the history is 1; a negative one acts against the direction.
    pub amplitude: f64,
    /// The axes that the direction is fixed in; default global.
    #[serde(default)]
    pub frame: LoadFrame,
    /// Factor on the amplitude over time.
    pub history: History,
}

/// The axes that a load's direction is fixed in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LoadFrame {
    /// Global axes: a dead load.
    #[default]
    Global,
}

/// A factor on a load over time, chosen by its key `kind`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum History {
    /// `kind = "half-sine"`: sin(π (t − start) / duration) while start ≤ t ≤ start + duration,
    /// otherwise 0.
    HalfSine {
        /// Time at which it begins; default 0. A negative one has begun before the run.
        #[serde(default)]
        start: f64,
        /// Length > 0 of the pulse in time.
        duration: f64,
    },
}
