//! Markers, joints, springs and bushings as they stand in the scene file.

use std::fmt;
use std::marker::PhantomData;

use dynamics::{Coordinate, Friction};
use schemars::JsonSchema;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer};

use crate::loads::history::History;
use crate::tie::joint::{AlongAndAbout, JointKind};

/// The tables that tie bodies together.
#[derive(Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct TieSections {
    /// With `true`, tied bodies begin deformed as the forces on them ask, so that nothing rings.
    pub relaxed: bool,
    /// `"equilibrium"`: bodies in joints, springs and bushings begin where the forces on them balance, down the energy from where they are placed.
    pub initial: Option<StartName>,
    /// Places on the ground.
    pub ground: GroundSection,
    /// Joints between markers of two bodies, or of one and the ground.
    pub joints: Vec<JointSection>,
    /// Springs and dampers along the line between two markers.
    pub springs: Vec<SpringSection>,
    /// Springs and dampers along and about the axes of the first of two markers.
    pub bushings: Vec<BushingSection>,
    /// Joints whose coordinates go together.
    pub couplings: Vec<CouplingSection>,
}

/// Where all bodies begin.
#[derive(Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum StartName {
    /// Where the forces on them balance.
    Equilibrium,
}

#[derive(Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct GroundSection {
    /// Places with axes on the ground, by name.
    pub markers: InOrder<GroundMarkerSection>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct MarkerSection {
    /// A point of the body, length, mesh axes; with a radius the centre of a ball.
    pub at: Option<[f64; 3]>,
    /// Radius > 0, length: the faces within the ball.
    pub radius: Option<f64>,
    /// Lowest and highest corner of a box along the mesh axes, length: the faces within it.
    pub r#box: Option<[[f64; 3]; 2]>,
    /// A physical surface: its faces; or a physical curve: its nodes.
    pub group: Option<String>,
    /// How the region carries the marker.
    pub tie: Option<TieName>,
    /// The number of strips of the faces side by side, 2 to 32, each a place of its own.
    pub patches: Option<u32>,
    /// Direction from strip to strip, mesh axes.
    pub along: Option<[f64; 3]>,
    /// The axis of a joint that turns or slides, mesh axes.
    pub z: Option<[f64; 3]>,
    /// The x axis, mesh axes; it is made to be at right angles to z.
    pub x: Option<[f64; 3]>,
}

/// The values of `tie`.
#[derive(Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum TieName {
    /// The region moves and turns as its mean does.
    Mean,
    /// Each node of the region is a place of its own.
    Nodes,
    /// The region moves as a rigid body.
    Rigid,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct GroundMarkerSection {
    /// Its place, length, global.
    pub at: [f64; 3],
    /// The axis of a joint that turns or slides, global.
    pub z: Option<[f64; 3]>,
    /// The x axis, global; it is made to be at right angles to z.
    pub x: Option<[f64; 3]>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct JointSection {
    /// Its name, unlike that of any other joint, spring or bushing.
    pub name: Option<String>,
    /// The kind: the motions that it leaves free.
    pub kind: Option<JointKind>,
    /// Motions that a joint without a kind holds: some of "x", "y", "z", "rx", "ry", "rz"; `[]` holds nothing.
    pub locked: Option<Vec<String>>,
    /// Two ends: "BODY.MARKER", "ground.MARKER" or "ground".
    pub between: Vec<String>,
    /// z axis at the start, global, of each end that has no axes of its own.
    pub axis: Option<[f64; 3]>,
    /// The coordinate over time.
    pub drive: Option<DriveSection>,
    /// Spring, damper, stops and friction along a free coordinate.
    pub spring: Option<JointSpringSection>,
    /// A force or a moment along a free coordinate over time.
    pub motor: Option<DriveSection>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct DriveSection {
    /// The coordinate, where the joint has several.
    pub along: Option<Coordinate>,
    /// The value where the history is 1: rad or length, moment or force.
    pub amplitude: f64,
    /// Factor over time; default constant.
    #[serde(default)]
    pub history: History,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct JointSpringSection {
    /// The coordinate, where the joint has several.
    pub along: Option<Coordinate>,
    /// Moment per rad, or force per length.
    #[serde(default)]
    pub stiffness: f64,
    /// Moment per angular velocity, or force per velocity.
    #[serde(default)]
    pub damping: f64,
    /// The coordinate at which the spring alone has no force.
    #[serde(default)]
    pub free: f64,
    /// Moment or force at all times, along the coordinate.
    #[serde(default)]
    pub preload: f64,
    /// Ends of the coordinate: stiff springs on one side.
    pub stops: Option<StopsSection>,
    /// Dry friction.
    pub friction: Option<Friction>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct StopsSection {
    /// Lowest coordinate.
    pub low: Option<f64>,
    /// Highest coordinate.
    pub high: Option<f64>,
    /// Moment per rad, or force per length, beyond them, > 0.
    pub stiffness: f64,
    /// Moment per angular velocity, or force per velocity, while they are touched.
    #[serde(default)]
    pub damping: f64,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SpringSection {
    /// Its name.
    pub name: Option<String>,
    /// Two ends: "BODY.MARKER" or "ground.MARKER".
    pub between: Vec<String>,
    /// Force per length.
    pub stiffness: f64,
    /// Force per velocity.
    #[serde(default)]
    pub damping: f64,
    /// Length without force; default the length at the start.
    pub free_length: Option<f64>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct BushingSection {
    /// Its name.
    pub name: Option<String>,
    /// Two ends: "BODY.MARKER", "ground.MARKER" or "ground".
    pub between: Vec<String>,
    /// Force per displacement and moment per rad.
    #[serde(default)]
    pub stiffness: AlongAndAbout,
    /// Force per velocity and moment per angular velocity.
    #[serde(default)]
    pub damping: AlongAndAbout,
}

#[derive(Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
#[schemars(tag = "kind")]
pub(crate) enum CouplingSection {
    /// The first joint turns `ratio` times as much as the second.
    Gear {
        /// Its name.
        name: Option<String>,
        /// Two joints that turn.
        joints: Vec<String>,
        /// Not 0; negative of two outer gears.
        ratio: f64,
    },
    /// The second joint slides by `radius` for each radian that the first one turns.
    Rack {
        /// Its name.
        name: Option<String>,
        /// A joint that turns and one that slides.
        joints: Vec<String>,
        /// Length, not 0.
        radius: f64,
    },
    /// The joint slides by `lead` for each full turn.
    Screw {
        /// Its name.
        name: Option<String>,
        /// A cylindrical joint.
        joint: String,
        /// Length, not 0.
        lead: f64,
    },
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
