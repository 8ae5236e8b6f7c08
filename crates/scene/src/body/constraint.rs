//! Constraints and drives of the body.

use nalgebra::Vector3;

use crate::loads::history::DrivenSpeed;
use crate::loads::unit_vector::unit;

/// A constraint of the body, chosen by the key `kind` of the `[[constraints]]` entry.
#[derive(Clone, Debug, PartialEq)]
pub enum Constraint {
    /// `kind = "pin"`: a point is held; the body turns about it.
    Pin {
        /// The point, length, mesh axes.
        at: [f64; 3],
        /// Radius > 0, length: the nodes within it are held rigidly by the ball joint at the point; `None` holds
        /// the node at the point alone, and all there is of a rigid body.
        radius: Option<f64>,
    },
    /// `kind = "hinge"`: a line is held; the body turns about it.
    Hinge {
        /// The line.
        line: HingeLine,
        /// The nodes that a rigid shaft on the line holds, all of these together. Empty: there is no shaft, and
        /// only nodes on the line are held. Always empty for a rigid body.
        shaft: Vec<Region>,
        /// The angular velocity about the line, radians per time; `None` leaves the body to turn freely. A driven
        /// flexible body has a shaft.
        motion: Option<DrivenSpeed>,
    },
    /// `kind = "clamp"`: a part of the body is held; no rigid motion is left.
    Clamp {
        /// The held part.
        region: Region,
    },
    /// `kind = "slider"`: a part of the body moves along a direction, without turning.
    Slider {
        /// Unit vector, mesh axes.
        direction: [f64; 3],
        /// The sliding part; `None` for a rigid body only.
        region: Option<Region>,
        /// The velocity along the direction, length per time; `None` leaves the body to slide freely.
        motion: Option<DrivenSpeed>,
    },
    /// `kind = "support"`, of which there may be several: parts of the body are held in some directions. The rigid motions
    /// that are left come from the geometry.
    Support {
        /// At least one.
        parts: Vec<HeldDirections>,
    },
}

impl Constraint {
    /// The speed that drives it.
    pub(crate) fn motion(&self) -> Option<&DrivenSpeed> {
        match self {
            Self::Hinge { motion, .. } | Self::Slider { motion, .. } => motion.as_ref(),
            Self::Pin { .. } | Self::Clamp { .. } | Self::Support { .. } => None,
        }
    }
}

/// A part of the body that is held in some directions.
#[derive(Clone, Debug, PartialEq)]
pub struct HeldDirections {
    /// The held part.
    pub region: Region,
    /// True for each held direction along x, y and z of the mesh; at least one.
    pub directions: [bool; 3],
}

/// The line of a hinge: the scene has `at` and `axis`, or `points`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HingeLine {
    /// Keys `at` and `axis`.
    Axis {
        /// A point of the line, length, mesh axes.
        at: [f64; 3],
        /// Unit vector, mesh axes.
        direction: [f64; 3],
    },
    /// Key `points`: two different points of the line, length, mesh axes.
    Points([[f64; 3]; 2]),
}

impl HingeLine {
    /// A point of the line, length, mesh axes: the first one.
    pub fn at(&self) -> [f64; 3] {
        match *self {
            Self::Axis { at, .. } => at,
            Self::Points([first, _]) => first,
        }
    }

    /// Unit vector along the line, mesh axes: from the first point to the second.
    pub fn direction(&self) -> [f64; 3] {
        match *self {
            Self::Axis { direction, .. } => direction,
            Self::Points([first, second]) => {
                unit(&(Vector3::from(second) - Vector3::from(first))).unwrap_or_default().into()
            }
        }
    }
}

/// A part of the mesh.
#[derive(Clone, Debug, PartialEq)]
pub enum Region {
    /// Keys `at` and `radius`: the nodes within a ball.
    Ball {
        /// Centre, length, mesh axes.
        at: [f64; 3],
        /// Radius > 0, length.
        radius: f64,
    },
    /// Key `box`: the nodes within a box along the mesh axes, its faces included.
    Box {
        /// Lowest coordinates, length, mesh axes.
        low: [f64; 3],
        /// Highest coordinates, each above the lowest.
        high: [f64; 3],
    },
    /// Key `group`: the nodes of a physical group of the mesh.
    Group(String),
}
