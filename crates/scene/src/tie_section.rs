//! Markers, joints, springs and bushings as they stand in the scene file.

use std::fmt;
use std::marker::PhantomData;

use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer};

use crate::joint::{AlongAndAbout, Coordinate, Friction, JointKind};
use crate::loads::history::History;

/// The tables that tie bodies together.
#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct TieSections {
    pub relaxed: bool,
    pub ground: GroundSection,
    pub joints: Vec<JointSection>,
    pub springs: Vec<SpringSection>,
    pub bushings: Vec<BushingSection>,
    pub couplings: Vec<CouplingSection>,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct GroundSection {
    pub markers: InOrder<GroundMarkerSection>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct MarkerSection {
    pub at: Option<[f64; 3]>,
    pub radius: Option<f64>,
    pub r#box: Option<[[f64; 3]; 2]>,
    pub group: Option<String>,
    pub tie: Option<TieName>,
    pub patches: Option<u32>,
    pub along: Option<[f64; 3]>,
    pub z: Option<[f64; 3]>,
    pub x: Option<[f64; 3]>,
}

/// The values of `tie`.
#[derive(Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum TieName {
    Mean,
    Nodes,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct GroundMarkerSection {
    pub at: [f64; 3],
    pub z: Option<[f64; 3]>,
    pub x: Option<[f64; 3]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct JointSection {
    pub name: Option<String>,
    pub kind: Option<JointKind>,
    pub locked: Option<Vec<String>>,
    pub between: Vec<String>,
    pub axis: Option<[f64; 3]>,
    pub drive: Option<DriveSection>,
    pub spring: Option<JointSpringSection>,
    pub motor: Option<DriveSection>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct DriveSection {
    pub along: Option<Coordinate>,
    pub amplitude: f64,
    #[serde(default)]
    pub history: History,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct JointSpringSection {
    pub along: Option<Coordinate>,
    #[serde(default)]
    pub stiffness: f64,
    #[serde(default)]
    pub damping: f64,
    #[serde(default)]
    pub free: f64,
    #[serde(default)]
    pub preload: f64,
    pub stops: Option<StopsSection>,
    pub friction: Option<Friction>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct StopsSection {
    pub low: Option<f64>,
    pub high: Option<f64>,
    pub stiffness: f64,
    #[serde(default)]
    pub damping: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SpringSection {
    pub name: Option<String>,
    pub between: Vec<String>,
    pub stiffness: f64,
    #[serde(default)]
    pub damping: f64,
    pub free_length: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct BushingSection {
    pub name: Option<String>,
    pub between: Vec<String>,
    #[serde(default)]
    pub stiffness: AlongAndAbout,
    #[serde(default)]
    pub damping: AlongAndAbout,
}

#[derive(Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) enum CouplingSection {
    Gear { name: Option<String>, joints: Vec<String>, ratio: f64 },
    Rack { name: Option<String>, joints: Vec<String>, radius: f64 },
    Screw { name: Option<String>, joint: String, lead: f64 },
}

/// The entries of a table by name, in the order of the text.
pub(crate) struct InOrder<T>(pub Vec<(String, T)>);

impl<T> Default for InOrder<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for InOrder<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Entries<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de>> Visitor<'de> for Entries<T> {
            type Value = InOrder<T>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a table of markers")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<InOrder<T>, A::Error> {
                let mut entries = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    entries.push(entry);
                }
                Ok(InOrder(entries))
            }
        }
        deserializer.deserialize_map(Entries(PhantomData))
    }
}
