//! The loads of a scene: what acts, and where.

use dynamics::LoadFrame;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::loads::history::History;

/// One `[[loads]]` entry, chosen by its key `kind`.
///
/// Every `direction` is a unit vector (the file may give a vector of any length but 0); a negative amplitude acts
/// against it. The amplitude is the load where its history is 1.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(tag = "kind")]
pub enum Load {
    /// `kind = "force"`: a force at a point.
    Force(Force),
    /// `kind = "moment"`: a moment at a point.
    Moment(Moment),
    /// `kind = "pressure"`: a pressure on a surface.
    Pressure(Pressure),
    /// `kind = "traction"`: a force per area on a surface.
    Traction(Traction),
    /// `kind = "gravity"`: the same acceleration for all of the body.
    Gravity(Gravity),
    /// `kind = "base-acceleration"`: the acceleration of the support.
    BaseAcceleration(BaseAcceleration),
}

impl Load {
    /// The name of its kind in a scene.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Force(_) => "force",
            Self::Moment(_) => "moment",
            Self::Pressure(_) => "pressure",
            Self::Traction(_) => "traction",
            Self::Gravity(_) => "gravity",
            Self::BaseAcceleration(_) => "base-acceleration",
        }
    }
}

/// A force at a point of the body.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Force {
    /// Where it acts, length, mesh axes.
    pub at: [f64; 3],
    /// Its direction, in the axes named by [`Force::frame`]: any vector but zero, which is brought to length one.
    pub direction: [f64; 3],
    /// Force.
    pub amplitude: f64,
    /// The axes that the direction is fixed in; default global.
    #[serde(default)]
    pub frame: LoadFrame,
    /// Factor on the amplitude over time; default constant.
    #[serde(default)]
    pub history: History,
}

/// A moment at a point of the body.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Moment {
    /// Where it acts, length, mesh axes.
    pub at: [f64; 3],
    /// Its axis, right-handed, in the axes named by [`Moment::frame`]: any vector but zero, which is brought to length one.
    pub direction: [f64; 3],
    /// Moment.
    pub amplitude: f64,
    /// The axes that the direction is fixed in; default global.
    #[serde(default)]
    pub frame: LoadFrame,
    /// Factor on the amplitude over time; default constant.
    #[serde(default)]
    pub history: History,
    /// Radius > 0, length, of the ball whose nodes take the moment; without it, the elements at the point take it.
    pub radius: Option<f64>,
}

/// A pressure on a surface: normal to it, against its outward normal where positive. It follows the body.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Pressure {
    /// Name of the physical surface in the mesh.
    pub group: String,
    /// Force per area.
    pub amplitude: f64,
    /// Factor on the amplitude over time; default constant.
    #[serde(default)]
    pub history: History,
}

/// A force per area on a surface, in one direction.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Traction {
    /// Name of the physical surface in the mesh.
    pub group: String,
    /// Its direction, in the axes named by [`Traction::frame`]: any vector but zero, which is brought to length one.
    pub direction: [f64; 3],
    /// Force per area.
    pub amplitude: f64,
    /// The axes that the direction is fixed in; default global.
    #[serde(default)]
    pub frame: LoadFrame,
    /// Factor on the amplitude over time; default constant.
    #[serde(default)]
    pub history: History,
}

/// Gravity: each mass m of the body has the weight m · amplitude · direction.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Gravity {
    /// Direction of the acceleration, global axes: any vector but zero, which is brought to length one.
    pub direction: [f64; 3],
    /// Acceleration.
    pub amplitude: f64,
    /// Factor on the amplitude over time; default constant.
    #[serde(default)]
    pub history: History,
}

/// The acceleration of the support; the motion of the body is then seen from there.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BaseAcceleration {
    /// Its direction, global axes: any vector but zero, which is brought to length one.
    pub direction: [f64; 3],
    /// Acceleration.
    pub amplitude: f64,
    /// Factor on the amplitude over time.
    pub history: History,
}
