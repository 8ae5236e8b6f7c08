//! The sections of the scene file as they stand there, where they are not what the scene holds.

use std::collections::BTreeMap;
use std::fmt;
use std::path::PathBuf;

use fem_tet10::{Material, PointMass};
use schemars::JsonSchema;
use serde::de::value::SeqAccessDeserializer;
use serde::de::{DeserializeSeed, EnumAccess, Error, SeqAccess, VariantAccess, Visitor};
use serde::{Deserialize, Deserializer};

use crate::body::effects::{Choice, Effects, auto};
use crate::body::modes::Rayleigh;
use crate::body::{Frame, Initial, TiedMass};
use crate::loads::history::DrivenSpeed;
use crate::loads::load::{Load, LoadSection};
use crate::methods::{formulation_names, scheme_names};
use crate::shared::Units;
use crate::tie::section::{InOrder, MarkerSection};

/// The whole file.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Sections {
    /// Title of the run, for headings.
    pub title: String,
    /// Labels of the units; nothing is converted.
    pub units: Units,
    /// The body of a scene of one.
    pub body: BodySection,
    /// The modes kept and their damping.
    pub modes: Option<ModesSection>,
    /// The effects that are simulated.
    #[serde(default)]
    pub effects: Effects,
    /// The paper's three reference points.
    pub frame: Option<Frame>,
    /// The state at the start.
    #[serde(default)]
    pub initial: Initial,
    /// Constraints of the body.
    #[serde(default)]
    pub constraints: Vec<ConstraintSection>,
    /// Loads on the body.
    #[serde(default)]
    #[schemars(with = "Vec<LoadSection>")]
    pub loads: Vec<Load>,
    /// How far and how to step.
    pub time: TimeSection,
    /// The choice of what is written.
    #[serde(default)]
    pub output: OutputSection,
    /// Error of the answer, between 0 and 1, for which `run` finds the settings.
    pub accuracy: Option<f64>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct BodySection {
    /// A mesh of ten-node tetrahedra, or geometry, relative to the scene file.
    pub mesh: Option<String>,
    /// A body file of `flexframe reduce`, instead of a mesh.
    pub file: Option<String>,
    /// Mass and stiffness from another program, instead of a mesh.
    pub matrices: Option<MatricesSection>,
    /// Largest size of an element where geometry is meshed, length; default gmsh's.
    pub mesh_size: Option<f64>,
    /// With `true`, straight edges of first-order elements get a node in the middle.
    pub raise_order: Option<bool>,
    /// The material of the whole mesh.
    pub material: Option<Material>,
    /// A material for each physical volume of the mesh.
    pub materials: Option<BTreeMap<String, Material>>,
    /// Masses at points of the body.
    #[serde(default)]
    pub point_masses: Vec<PointMass>,
    /// Masses on the body or beside it that move with some of its nodes.
    #[serde(default)]
    pub tied_masses: Vec<TiedMass>,
    /// Mass properties of a rigid body without a mesh.
    pub rigid: Option<RigidSection>,
    /// Places with axes, by name: the ends of joints, springs and bushings.
    #[serde(default)]
    pub markers: InOrder<MarkerSection>,
}

/// The files of a body of matrices as the scene names them.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct MatricesSection {
    /// The file of the mass matrix.
    pub mass: String,
    /// The file of the stiffness matrix.
    pub stiffness: String,
    /// The file of the nodes and their positions.
    pub nodes: String,
    /// The file of the degrees of freedom, where the matrices need one.
    pub dofs: Option<String>,
}

/// A rigid body as the file gives it.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct RigidSection {
    /// Mass > 0.
    pub mass: f64,
    /// Centre of mass, length, mesh axes.
    pub center_of_mass: [f64; 3],
    /// Inertia tensor, with Jxy = −∫ x y dm.
    pub inertia: [[f64; 3]; 3],
    /// The point of the inertia; the centre of mass if absent.
    pub about: Option<[f64; 3]>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ModesSection {
    /// Number of flexible modes, the lowest first; or "auto": as many as the loads call for.
    pub flexible: CountOrAuto,
    /// The largest number of modes with `flexible = "auto"`; default 40.
    pub most: Option<usize>,
    /// Damping ratio of every flexible mode, or a list with one for each.
    pub damping_ratio: Option<NumberOrList>,
    /// Pairs of frequency (cycles per time) and damping ratio, with straight lines between them.
    pub damping_table: Option<Vec<[f64; 2]>>,
    /// Damping in proportion to mass and stiffness.
    pub rayleigh: Option<Rayleigh>,
    /// Static shapes of the loads and of the centrifugal field beside the modes; default "auto".
    #[serde(default)]
    pub static_correction: Choice,
    /// The modes that bend the body far: the number of first ones (1 to 4), or their numbers from 1.
    pub large: Option<CountOrList>,
    /// The most other modes that follow the large ones (0 to 7); default 3.
    pub following: Option<usize>,
    /// The bent rest that all modes are about; default the undeformed body.
    pub about: Option<AboutSection>,
    /// A CSV file of measured frequencies and damping, which replace those of the model.
    pub measured: Option<PathBuf>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(untagged, expecting = "\"spin\", \"loads\", \"auto\", or a table with `angular_velocity` and `loads`")]
pub(crate) enum AboutSection {
    Named(AboutName),
    Given(AboutGiven),
}

#[derive(Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum AboutName {
    /// In the largest spin of the drive.
    Spin,
    /// Under the steady forces and gravity.
    Loads,
    /// Both, where they bend the body far.
    Auto,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct AboutGiven {
    /// A steady spin, radians per time, axes of the body.
    #[serde(default)]
    pub angular_velocity: [f64; 3],
    /// True if the steady forces and gravity act.
    #[serde(default)]
    pub loads: bool,
}

#[derive(Deserialize, JsonSchema)]
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
#[derive(Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
#[schemars(tag = "kind")]
pub(crate) enum ConstraintSection {
    /// A point is held; the body turns about it.
    Pin {
        /// A point, length, mesh axes; with a radius the centre of a ball.
        at: [f64; 3],
        /// Radius > 0, length, of the ball whose nodes are held.
        radius: Option<f64>,
    },
    /// A line is held; the body turns about it.
    Hinge {
        /// A point, length, mesh axes; with a radius the centre of a ball.
        at: Option<[f64; 3]>,
        /// Direction of the line, mesh axes.
        axis: Option<[f64; 3]>,
        /// Two points of the line, length, mesh axes.
        points: Option<[[f64; 3]; 2]>,
        /// Radius > 0, length, of the ball whose nodes are held.
        radius: Option<f64>,
        /// Lowest and highest corner of a box along the mesh axes, length.
        r#box: Option<[[f64; 3]; 2]>,
        /// Name of a physical group of the mesh.
        group: Option<String>,
        /// Its speed over time: amplitude times history.
        motion: Option<DrivenSpeed>,
    },
    /// A part of the body is held; no rigid motion is left.
    Clamp {
        /// A point, length, mesh axes; with a radius the centre of a ball.
        at: Option<[f64; 3]>,
        /// Radius > 0, length, of the ball whose nodes are held.
        radius: Option<f64>,
        /// Lowest and highest corner of a box along the mesh axes, length.
        r#box: Option<[[f64; 3]; 2]>,
        /// Name of a physical group of the mesh.
        group: Option<String>,
    },
    /// A part of the body moves along a direction, without turning.
    Slider {
        /// Direction of the motion that is left, mesh axes.
        direction: [f64; 3],
        /// A point, length, mesh axes; with a radius the centre of a ball.
        at: Option<[f64; 3]>,
        /// Radius > 0, length, of the ball whose nodes are held.
        radius: Option<f64>,
        /// Lowest and highest corner of a box along the mesh axes, length.
        r#box: Option<[[f64; 3]; 2]>,
        /// Name of a physical group of the mesh.
        group: Option<String>,
        /// Its speed over time: amplitude times history.
        motion: Option<DrivenSpeed>,
    },
    /// A part of the body is held in some directions.
    Support {
        /// The held directions: some of "x", "y", "z".
        directions: Vec<String>,
        /// A point, length, mesh axes; with a radius the centre of a ball.
        at: Option<[f64; 3]>,
        /// Radius > 0, length, of the ball whose nodes are held.
        radius: Option<f64>,
        /// Lowest and highest corner of a box along the mesh axes, length.
        r#box: Option<[[f64; 3]; 2]>,
        /// Name of a physical group of the mesh.
        group: Option<String>,
    },
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct TimeSection {
    /// The run goes from 0 to here.
    pub end: f64,
    /// Longest step.
    pub step: Option<f64>,
    /// Limit of the sum of the estimated relative errors of all steps, between 0 and 1.
    pub tolerance: Option<f64>,
    /// The equations of motion; default "conservative", with the scheme "paper" "paper".
    pub formulation: Option<Formulation>,
    /// The way from one step to the next; default "exponential", of bodies in joints "radau".
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

#[derive(Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct OutputSection {
    /// Write every N-th step; default 1, or as many as leave 5000 rows.
    pub every: Option<u64>,
    /// Write at the multiples of this time; default, with a tolerance, `end`/500.
    pub interval: Option<f64>,
    /// Points whose motion is written, by name: positions, length, mesh axes.
    pub points: BTreeMap<String, [f64; 3]>,
    /// With `true`, the stress at the points is written, too.
    pub stress: bool,
    /// With `true`, the largest von Mises stress of the whole body among the rows is found.
    pub peak_stress: bool,
}
