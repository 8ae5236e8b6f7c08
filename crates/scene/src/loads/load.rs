//! The loads of a scene: what acts, and where.

use dynamics::LoadFrame;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::loads::history::History;

/// A load of a body: one `[[loads]]` entry.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "LoadSection")]
pub struct Load {
    /// The kind: a force, a moment, …
    pub kind: LoadKind,
    /// The part of the body that it acts on.
    pub place: LoadPlace,
    /// Unit vector that it acts along where its amplitude is positive, in the axes of `frame`; zero of a pressure, which is normal to its
    /// surface.
    pub direction: [f64; 3],
    /// The axes that the direction is fixed in.
    pub frame: LoadFrame,
    /// The load where its history is 1: a force, a moment, a force per area or an acceleration.
    pub amplitude: f64,
    /// Factor on the amplitude over time.
    pub history: History,
}

/// Key `kind` of a load.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum LoadKind {
    /// A force at a point.
    Force,
    /// A moment at a point.
    Moment,
    /// A pressure on a surface: normal to it, against its outward normal where positive.
    Pressure,
    /// A force per area on a surface, in one direction.
    Traction,
    /// The same acceleration of all of the body: each mass m has the weight m · amplitude · direction.
    Gravity,
    /// The acceleration of the support; the motion of the body is seen from there.
    BaseAcceleration,
}

/// The part of a body that a load acts on.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum LoadPlace {
    /// A point, length, mesh axes.
    Point([f64; 3]),
    /// The nodes in a ball.
    Ball {
        /// Its center, length, mesh axes.
        at: [f64; 3],
        /// Its radius > 0, length.
        radius: f64,
    },
    /// A physical surface of the mesh.
    Surface(String),
    /// All masses.
    Everywhere,
}

impl LoadKind {
    /// Its name in a scene.
    pub fn name(self) -> &'static str {
        match self {
            Self::Force => "force",
            Self::Moment => "moment",
            Self::Pressure => "pressure",
            Self::Traction => "traction",
            Self::Gravity => "gravity",
            Self::BaseAcceleration => "base-acceleration",
        }
    }
}

impl Load {
    /// True if it is gravity, which a scene can switch off as an effect.
    pub fn is_gravity(&self) -> bool {
        self.kind == LoadKind::Gravity
    }

    /// True if it keeps its direction in the body or in the material.
    pub fn follows(&self) -> bool {
        self.frame != LoadFrame::Global
    }

    /// The acceleration of the support where the history is 1, global components: zero of other loads.
    pub fn base_acceleration(&self) -> [f64; 3] {
        let amplitude = if self.kind == LoadKind::BaseAcceleration { self.amplitude } else { 0.0 };
        self.direction.map(|x| x * amplitude)
    }
}

/// One `[[loads]]` entry, chosen by its key `kind`.
///
/// Every `direction` is a unit vector (the file may give a vector of any length but 0); a negative amplitude acts
/// against it. The amplitude is the load where its history is 1.
#[derive(Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
#[schemars(tag = "kind", rename = "Load")]
pub(crate) enum LoadSection {
    /// `kind = "force"`: a force at a point.
    Force {
        /// Where it acts, length, mesh axes.
        at: [f64; 3],
        /// Its direction, in the axes named by `frame`: any vector but zero, which is brought to length one.
        direction: [f64; 3],
        /// Force.
        amplitude: f64,
        /// The axes that the direction is fixed in; default global.
        #[serde(default)]
        frame: LoadFrame,
        /// Factor on the amplitude over time; default constant.
        #[serde(default)]
        history: History,
    },
    /// `kind = "moment"`: a moment at a point.
    Moment {
        /// Where it acts, length, mesh axes.
        at: [f64; 3],
        /// Its axis, right-handed, in the axes named by `frame`: any vector but zero, which is brought to length one.
        direction: [f64; 3],
        /// Moment.
        amplitude: f64,
        /// The axes that the direction is fixed in; default global.
        #[serde(default)]
        frame: LoadFrame,
        /// Factor on the amplitude over time; default constant.
        #[serde(default)]
        history: History,
        /// Radius > 0, length, of the ball whose nodes take the moment; without it, the elements at the point take it.
        radius: Option<f64>,
    },
    /// `kind = "pressure"`: a pressure on a surface.
    Pressure {
        /// Name of the physical surface in the mesh.
        group: String,
        /// Force per area.
        amplitude: f64,
        /// Factor on the amplitude over time; default constant.
        #[serde(default)]
        history: History,
    },
    /// `kind = "traction"`: a force per area on a surface.
    Traction {
        /// Name of the physical surface in the mesh.
        group: String,
        /// Its direction, in the axes named by `frame`: any vector but zero, which is brought to length one.
        direction: [f64; 3],
        /// Force per area.
        amplitude: f64,
        /// The axes that the direction is fixed in; default global.
        #[serde(default)]
        frame: LoadFrame,
        /// Factor on the amplitude over time; default constant.
        #[serde(default)]
        history: History,
    },
    /// `kind = "gravity"`: the same acceleration for all of the body.
    Gravity {
        /// Direction of the acceleration, global axes: any vector but zero, which is brought to length one.
        direction: [f64; 3],
        /// Acceleration.
        amplitude: f64,
        /// Factor on the amplitude over time; default constant.
        #[serde(default)]
        history: History,
    },
    /// `kind = "base-acceleration"`: the acceleration of the support.
    BaseAcceleration {
        /// Its direction, global axes: any vector but zero, which is brought to length one.
        direction: [f64; 3],
        /// Acceleration.
        amplitude: f64,
        /// Factor on the amplitude over time.
        history: History,
    },
}

impl From<LoadSection> for Load {
    fn from(section: LoadSection) -> Self {
        use {LoadKind as Kind, LoadPlace as Place, LoadSection as Section};
        let global = LoadFrame::Global;
        let (kind, place, direction, frame, amplitude, history) = match section {
            Section::Force { at, direction, amplitude, frame, history } => {
                (Kind::Force, Place::Point(at), direction, frame, amplitude, history)
            }
            Section::Moment { at, direction, amplitude, frame, history, radius } => {
                let place = radius.map_or(Place::Point(at), |radius| Place::Ball { at, radius });
                (Kind::Moment, place, direction, frame, amplitude, history)
            }
            Section::Pressure { group, amplitude, history } => {
                (Kind::Pressure, Place::Surface(group), [0.0; 3], LoadFrame::Body, amplitude, history)
            }
            Section::Traction { group, direction, amplitude, frame, history } => {
                (Kind::Traction, Place::Surface(group), direction, frame, amplitude, history)
            }
            Section::Gravity { direction, amplitude, history } => {
                (Kind::Gravity, Place::Everywhere, direction, global, amplitude, history)
            }
            Section::BaseAcceleration { direction, amplitude, history } => {
                (Kind::BaseAcceleration, Place::Everywhere, direction, global, amplitude, history)
            }
        };
        Self { kind, place, direction, frame, amplitude, history }
    }
}
