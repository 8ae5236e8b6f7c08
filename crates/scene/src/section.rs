//! The sections of the scene file as they stand there, where they are not what the scene holds.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::load::Load;
use crate::scene::{Frame, Initial, Material, Modes, PointMass, Units};

/// The whole file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Sections {
    pub title: String,
    pub units: Units,
    pub body: BodySection,
    pub modes: Modes,
    pub frame: Option<Frame>,
    #[serde(default)]
    pub initial: Initial,
    #[serde(default)]
    pub loads: Vec<Load>,
    pub time: TimeSection,
    #[serde(default)]
    pub output: OutputSection,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct BodySection {
    pub mesh: String,
    pub material: Option<Material>,
    pub materials: Option<BTreeMap<String, Material>>,
    #[serde(default)]
    pub point_masses: Vec<PointMass>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct TimeSection {
    pub end: f64,
    pub step: Option<f64>,
    pub tolerance: Option<f64>,
    pub formulation: Option<Formulation>,
    pub scheme: Option<Scheme>,
}

/// The equations of motion.
#[derive(Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Formulation {
    Conservative,
    Paper,
}

/// The way from one step to the next.
#[derive(Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Scheme {
    Paper,
    Rkmk4,
    Exponential,
    Strang,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct OutputSection {
    pub every: Option<u64>,
    pub interval: Option<f64>,
    pub points: BTreeMap<String, [f64; 3]>,
}
