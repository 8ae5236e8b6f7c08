//! The sections of the scene file as they stand there, where they are not what the scene holds.

use std::collections::BTreeMap;
use std::fmt;

use serde::de::value::SeqAccessDeserializer;
use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

use crate::constraint::Drive;
use crate::effects::{Choice, Effects, auto};
use crate::load::Load;
use crate::modes::Rayleigh;
use crate::scene::{Frame, Initial, Material, PointMass, Units};

/// The whole file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Sections {
    pub title: String,
    pub units: Units,
    pub body: BodySection,
    pub modes: Option<ModesSection>,
    #[serde(default)]
    pub effects: Effects,
    pub frame: Option<Frame>,
    #[serde(default)]
    pub initial: Initial,
    #[serde(default)]
    pub constraints: Vec<ConstraintSection>,
    #[serde(default)]
    pub loads: Vec<Load>,
    pub time: TimeSection,
    #[serde(default)]
    pub output: OutputSection,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct BodySection {
    pub mesh: Option<String>,
    pub material: Option<Material>,
    pub materials: Option<BTreeMap<String, Material>>,
    #[serde(default)]
    pub point_masses: Vec<PointMass>,
    pub rigid: Option<RigidSection>,
}

/// A rigid body as the file gives it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RigidSection {
    pub mass: f64,
    pub center_of_mass: [f64; 3],
    pub inertia: [[f64; 3]; 3],
    /// The point of the inertia; the centre of mass if absent.
    pub about: Option<[f64; 3]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ModesSection {
    pub flexible: CountOrAuto,
    pub most: Option<usize>,
    pub damping_ratio: Option<NumberOrList>,
    pub damping_table: Option<Vec<[f64; 2]>>,
    pub rayleigh: Option<Rayleigh>,
    #[serde(default)]
    pub static_correction: Choice,
}

pub(crate) enum CountOrAuto {
    Count(usize),
    Auto,
}

impl<'de> Deserialize<'de> for CountOrAuto {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct CountOrAutoVisitor;
        impl Visitor<'_> for CountOrAutoVisitor {
            type Value = CountOrAuto;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a whole number, 0 or more, or \"auto\"")
            }

            fn visit_u64<E: Error>(self, count: u64) -> Result<CountOrAuto, E> {
                usize::try_from(count).map(CountOrAuto::Count).map_err(E::custom)
            }

            fn visit_str<E: Error>(self, text: &str) -> Result<CountOrAuto, E> {
                auto(text, &self).map(|()| CountOrAuto::Auto)
            }
        }
        deserializer.deserialize_any(CountOrAutoVisitor)
    }
}

pub(crate) enum NumberOrList {
    Number(f64),
    List(Vec<f64>),
}

impl<'de> Deserialize<'de> for NumberOrList {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct NumberOrListVisitor;
        impl<'de> Visitor<'de> for NumberOrListVisitor {
            type Value = NumberOrList;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a finite number, or a list of them")
            }

            fn visit_f64<E: Error>(self, number: f64) -> Result<NumberOrList, E> {
                Ok(NumberOrList::Number(number))
            }

            fn visit_u64<E: Error>(self, number: u64) -> Result<NumberOrList, E> {
                Ok(NumberOrList::Number(number as f64))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<NumberOrList, A::Error> {
                Vec::deserialize(SeqAccessDeserializer::new(list)).map(NumberOrList::List)
            }
        }
        deserializer.deserialize_any(NumberOrListVisitor)
    }
}

/// What holds the body, as the file gives it.
#[derive(Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) enum ConstraintSection {
    Pin {
        at: [f64; 3],
        radius: Option<f64>,
    },
    Hinge {
        at: Option<[f64; 3]>,
        axis: Option<[f64; 3]>,
        points: Option<[[f64; 3]; 2]>,
        radius: Option<f64>,
        r#box: Option<[[f64; 3]; 2]>,
        group: Option<String>,
        motion: Option<Drive>,
    },
    Clamp {
        at: Option<[f64; 3]>,
        radius: Option<f64>,
        r#box: Option<[[f64; 3]; 2]>,
        group: Option<String>,
    },
    Slider {
        direction: [f64; 3],
        at: Option<[f64; 3]>,
        radius: Option<f64>,
        r#box: Option<[[f64; 3]; 2]>,
        group: Option<String>,
        motion: Option<Drive>,
    },
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
