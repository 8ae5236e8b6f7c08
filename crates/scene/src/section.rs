//! The sections of the scene file as they stand there, where they are not what the scene holds.

use std::collections::BTreeMap;
use std::fmt;
use std::path::PathBuf;

use fem_tet10::{Material, PointMass};
use serde::de::value::SeqAccessDeserializer;
use serde::de::{DeserializeSeed, EnumAccess, Error, SeqAccess, VariantAccess, Visitor};
use serde::{Deserialize, Deserializer};

use crate::body::effects::{Choice, Effects, auto};
use crate::body::modes::Rayleigh;
use crate::loads::history::DrivenSpeed;
use crate::loads::load::Load;
use crate::methods::{formulation_names, scheme_names};
use crate::scene::{Frame, Initial, Units};
use crate::tie_section::{InOrder, MarkerSection};

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
    pub file: Option<String>,
    pub matrices: Option<MatricesSection>,
    pub mesh_size: Option<f64>,
    pub raise_order: Option<bool>,
    pub material: Option<Material>,
    pub materials: Option<BTreeMap<String, Material>>,
    #[serde(default)]
    pub point_masses: Vec<PointMass>,
    pub rigid: Option<RigidSection>,
    #[serde(default)]
    pub markers: InOrder<MarkerSection>,
}

/// The files of a body of matrices as the scene names them.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct MatricesSection {
    pub mass: String,
    pub stiffness: String,
    pub nodes: String,
    pub dofs: Option<String>,
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
    pub large: Option<CountOrList>,
    pub following: Option<usize>,
    /// A CSV file of measured frequencies and damping, which replace those of the model.
    pub measured: Option<PathBuf>,
}

#[derive(Deserialize)]
#[serde(untagged, expecting = "a number of modes or a list of their numbers")]
pub(crate) enum CountOrList {
    Count(usize),
    List(Vec<usize>),
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

/// A constraint of the body, as the file gives it.
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
        motion: Option<DrivenSpeed>,
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
        motion: Option<DrivenSpeed>,
    },
    Support {
        directions: Vec<String>,
        at: Option<[f64; 3]>,
        radius: Option<f64>,
        r#box: Option<[[f64; 3]; 2]>,
        group: Option<String>,
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

/// A name from the list of schemes.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) struct Formulation(pub &'static str);

/// A name from the list of schemes.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) struct Scheme(pub &'static str);

impl<'de> Deserialize<'de> for Formulation {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        one_of_names(deserializer, formulation_names()).map(Self)
    }
}

impl<'de> Deserialize<'de> for Scheme {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        one_of_names(deserializer, scheme_names()).map(Self)
    }
}

/// One of some names: as a text, or as the key `kind` of a table.
fn one_of_names<'de, D: Deserializer<'de>>(
    deserializer: D,
    names: &'static [&'static str],
) -> Result<&'static str, D::Error> {
    #[derive(Clone, Copy)]
    struct OneOf(&'static [&'static str]);
    impl<'de> Visitor<'de> for OneOf {
        type Value = &'static str;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            write!(f, "one of {}", self.0.join(", "))
        }

        fn visit_str<E: Error>(self, text: &str) -> Result<Self::Value, E> {
            self.0.iter().copied().find(|name| *name == text).ok_or_else(|| E::unknown_variant(text, self.0))
        }

        fn visit_enum<A: EnumAccess<'de>>(self, data: A) -> Result<Self::Value, A::Error> {
            let (name, rest) = data.variant_seed(self)?;
            rest.unit_variant()?;
            Ok(name)
        }
    }
    impl<'de> DeserializeSeed<'de> for OneOf {
        type Value = &'static str;

        fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self::Value, D::Error> {
            deserializer.deserialize_identifier(self)
        }
    }
    deserializer.deserialize_enum("name", names, OneOf(names))
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct OutputSection {
    pub every: Option<u64>,
    pub interval: Option<f64>,
    pub points: BTreeMap<String, [f64; 3]>,
    pub stress: bool,
    pub peak_stress: bool,
}
