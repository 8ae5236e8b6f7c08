//! Joints, springs and bushings between the bodies of a scene.

use dynamics::{Coordinate, Friction, Stops};
use schemars::JsonSchema;
use serde::Deserialize;

use crate::body::constraint::Constraint;
use crate::loads::history::History;

/// An end of a joint, a spring or a bushing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// A marker of a body.
    Body {
        /// Number of the body in the scene.
        body: usize,
        /// Number of the marker in [`Body::markers`](crate::Body::markers).
        marker: usize,
    },
    /// The ground.
    Ground {
        /// Number of the marker in [`Scene::ground`](crate::Scene::ground); `None` is where the other end is at the start.
        marker: Option<usize>,
    },
}

impl End {
    /// The number of its body; `None` on the ground.
    pub fn body(&self) -> Option<usize> {
        match *self {
            Self::Body { body, .. } => Some(body),
            Self::Ground { .. } => None,
        }
    }
}

/// Kinds of joints, by what they leave free of the motion of the second end against the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum JointKind {
    /// Nothing.
    Fixed,
    /// The turn about the z axis.
    Revolute,
    /// The slide along the z axis.
    Prismatic,
    /// The slide along the z axis, and the turn about it.
    Cylindrical,
    /// All turns.
    Spherical,
    /// Turns about the x axis of the first end and the y axis of the second, which stay at right angles.
    Universal,
    /// Slides at right angles to the z axis, and the turn about it.
    Planar,
    /// Key `locked` in the place of `kind`: all that it does not name.
    #[serde(skip)]
    Other(Locked),
}

/// Motions of the second end against the first that a joint does not leave free. One turn alone is that of two axes, the next
/// of the first end and the one after of the second, which stay at right angles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Locked {
    /// Displacements along x, y and z of the first end.
    pub displacements: [bool; 3],
    /// Turns about x, y and z.
    pub turns: [bool; 3],
}

impl JointKind {
    /// The joint to the ground that a constraint is, of supports the first part, and its z axis where it has one, mesh axes.
    pub(crate) fn of_constraint(constraint: &Constraint) -> (Self, Option<[f64; 3]>) {
        match constraint {
            Constraint::Pin { .. } => (Self::Spherical, None),
            Constraint::Hinge { line, .. } => (Self::Revolute, Some(line.direction())),
            Constraint::Clamp { .. } => (Self::Fixed, None),
            Constraint::Slider { direction, .. } => (Self::Prismatic, Some(*direction)),
            Constraint::Support { parts } => {
                let displacements = parts.first().map_or([false; 3], |part| part.directions);
                (Self::Other(Locked { displacements, turns: [false; 3] }), Some([0.0, 0.0, 1.0]))
            }
        }
    }

    /// The name in a scene.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fixed => "fixed",
            Self::Revolute => "revolute",
            Self::Prismatic => "prismatic",
            Self::Cylindrical => "cylindrical",
            Self::Spherical => "spherical",
            Self::Universal => "universal",
            Self::Planar => "planar",
            Self::Other(_) => "locked",
        }
    }

    /// The motions that it does not leave free.
    pub fn locked(self) -> Locked {
        let locked = |displacements, turns| Locked { displacements, turns };
        match self {
            Self::Fixed => locked([true; 3], [true; 3]),
            Self::Revolute => locked([true; 3], [true, true, false]),
            Self::Prismatic => locked([true, true, false], [true; 3]),
            Self::Cylindrical => locked([true, true, false], [true, true, false]),
            Self::Spherical => locked([true; 3], [false; 3]),
            Self::Universal => locked([true; 3], [false, false, true]),
            Self::Planar => locked([false, false, true], [true, true, false]),
            Self::Other(locked) => locked,
        }
    }

    /// The free coordinates that a drive, a spring or a motor can act along.
    pub fn coordinates(self) -> &'static [Coordinate] {
        let Locked { displacements, turns } = self.locked();
        match (turns, displacements[2]) {
            ([true, true, false], true) => &[Coordinate::Turn],
            ([true, true, false], false) => &[Coordinate::Turn, Coordinate::Slide],
            ([true, true, true], false) => &[Coordinate::Slide],
            _ => &[],
        }
    }

    /// True if its z axis is to be named.
    pub fn needs_axis(self) -> bool {
        !matches!(self, Self::Fixed | Self::Spherical)
    }
}

/// A joint: one `[[joints]]` entry, or a constraint of a body that joints, springs or bushings hold, too.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Its key path in the scene file, such as `joints[2]` or `bodies.arm.constraints[0]`.
    pub key: String,
    /// Its name, unlike that of any other joint, spring or bushing, without `.`, `/` and control characters.
    pub name: String,
    /// Key `kind`.
    pub kind: JointKind,
    /// Its two ends: different markers, not of one body.
    pub between: [End; 2],
    /// Unit vector, global at the start: the z axis of each end that has no axes of its own.
    pub axis: Option<[f64; 3]>,
    /// The motion along a free coordinate, where that is given.
    pub drive: Option<JointDrive>,
    /// Spring, damper, stops and friction along a free coordinate.
    pub spring: Option<JointSpring>,
    /// A force or moment along a free coordinate.
    pub motor: Option<JointDrive>,
}

/// A coordinate of a joint (rad or length), or a moment or force along it, over time: the amplitude times the history.
#[derive(Clone, Debug, PartialEq)]
pub struct JointDrive {
    /// The coordinate.
    pub along: Coordinate,
    /// Value where the history is 1.
    pub amplitude: f64,
    /// Factor over time.
    pub history: History,
}

/// Forces along a free coordinate of a joint by its value and its rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointSpring {
    /// The coordinate.
    pub along: Coordinate,
    /// Moment per rad, or force per length, ≥ 0.
    pub stiffness: f64,
    /// Moment per angular velocity, or force per velocity, ≥ 0.
    pub damping: f64,
    /// Coordinate at which the spring alone has no force.
    pub free: f64,
    /// Moment or force at all times, along the coordinate.
    pub preload: f64,
    /// Ends of the coordinate.
    pub stops: Option<Stops>,
    /// Dry friction.
    pub friction: Option<Friction>,
}

/// A spring and a damper along the line between two markers: one `[[springs]]` entry.
#[derive(Clone, Debug, PartialEq)]
pub struct Spring {
    /// Its name, as [`Joint::name`].
    pub name: String,
    /// Its two ends, as [`Joint::between`], none on the ground without a marker.
    pub between: [End; 2],
    /// Force per length, ≥ 0.
    pub stiffness: f64,
    /// Force per velocity, ≥ 0.
    pub damping: f64,
    /// Length without force, ≥ 0; `None` is the length at the start.
    pub free_length: Option<f64>,
}

/// Springs and dampers along and about the axes of the first of two markers: one `[[bushings]]` entry.
#[derive(Clone, Debug, PartialEq)]
pub struct Bushing {
    /// Its name, as [`Joint::name`].
    pub name: String,
    /// Its two ends, as [`Joint::between`].
    pub between: [End; 2],
    /// Force per displacement and moment per rad, each ≥ 0.
    pub stiffness: AlongAndAbout,
    /// Force per velocity and moment per angular velocity, each ≥ 0.
    pub damping: AlongAndAbout,
}

/// Numbers for each axis of a marker.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct AlongAndAbout {
    /// Along x, y and z.
    pub translation: [f64; 3],
    /// About x, y and z.
    pub rotation: [f64; 3],
}

/// Joints whose coordinates go together: one `[[couplings]]` entry.
#[derive(Clone, Debug, PartialEq)]
pub struct Coupling {
    /// Its name, as [`Joint::name`].
    pub name: String,
    /// The joints, and how their coordinates go together from the start on.
    pub kind: CouplingKind,
}

/// How coordinates go together. Joints are numbers in [`Scene::joints`](crate::Scene::joints).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CouplingKind {
    /// `kind = "gear"`: the first joint turns `ratio` times as much as the second.
    Gear {
        /// Two joints that turn.
        joints: [usize; 2],
        /// Not 0; negative of two outer gears.
        ratio: f64,
    },
    /// `kind = "rack"`: the second joint slides by `radius` for each radian that the first one turns.
    Rack {
        /// A joint that turns and one that slides.
        joints: [usize; 2],
        /// Length, not 0.
        radius: f64,
    },
    /// `kind = "screw"`: the joint slides by `lead` for each full turn.
    Screw {
        /// A cylindrical joint.
        joint: usize,
        /// Length, not 0.
        lead: f64,
    },
}

impl CouplingKind {
    /// True if it acts along a coordinate of a joint.
    pub fn acts_on(&self, joint: usize, along: Coordinate) -> bool {
        match (*self, along) {
            (Self::Gear { joints, .. }, Coordinate::Turn) => joints.contains(&joint),
            (Self::Gear { .. }, Coordinate::Slide) => false,
            (Self::Rack { joints: [turns, _], .. }, Coordinate::Turn) => turns == joint,
            (Self::Rack { joints: [_, slides], .. }, Coordinate::Slide) => slides == joint,
            (Self::Screw { joint: of, .. }, _) => of == joint,
        }
    }

    /// The joints.
    pub fn joints(&self) -> [usize; 2] {
        match *self {
            Self::Gear { joints, .. } | Self::Rack { joints, .. } => joints,
            Self::Screw { joint, .. } => [joint; 2],
        }
    }
}
