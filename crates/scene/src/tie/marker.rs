//! Places with axes that bodies and the ground carry: the ends of joints.

use crate::body::constraint::{Constraint, Region};
use crate::document::join;

/// A place with axes on a body: `[bodies.NAME.markers.MARKER]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Marker {
    /// Its name among the markers of its body: not empty, without `.`, `/` and control characters.
    pub name: String,
    /// The part of the body that carries it.
    pub place: MarkerPlace,
    /// How a region carries it; [`Tie::Mean`] of a point.
    pub tie: Tie,
    /// Its axes, mesh axes; `None` leaves them to the joint.
    pub axes: Option<MarkerAxes>,
}

/// How a region carries a marker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tie {
    /// It moves and turns as the mean of the region does.
    Mean,
    /// Key `patches`: number of strips of its faces side by side, each as its own mean.
    Patches {
        /// Two or more.
        count: usize,
        /// Unit vector, mesh axes: the direction from strip to strip; `None` is that in which the faces extend the farthest.
        along: Option<[f64; 3]>,
    },
    /// `tie = "nodes"`: each node by itself.
    Nodes,
    /// `tie = "rigid"`: its nodes move as one rigid body.
    Rigid,
}

/// The part of a body that carries a marker.
#[derive(Clone, Debug, PartialEq)]
pub enum MarkerPlace {
    /// Key `at` alone: a point of the body, length, mesh axes.
    Point([f64; 3]),
    /// Faces in a part of the mesh, or its nodes.
    Region(Region),
    /// The part that a constraint of the body holds, beside joints: the end of the joint to the ground that it is.
    Held {
        /// The constraint; of supports one part.
        constraint: Constraint,
        /// Its number among `[[constraints]]`.
        number: usize,
    },
}

impl Marker {
    /// The key path of it in the scene of its body, for messages.
    pub fn key(&self) -> String {
        match self.place {
            MarkerPlace::Held { number, .. } => format!("constraints[{number}]"),
            MarkerPlace::Point(_) | MarkerPlace::Region(_) => join("body.markers", &self.name),
        }
    }

    /// The key path of how its region carries it.
    pub fn key_of_tie(&self) -> String {
        match self.place {
            MarkerPlace::Held { .. } => self.key(),
            MarkerPlace::Point(_) | MarkerPlace::Region(_) => join(&self.key(), "tie"),
        }
    }
}

/// Axes of a marker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarkerAxes {
    /// Unit vector: the axis of a joint that turns or slides.
    pub z: [f64; 3],
    /// Unit vector at right angles to z; `None` leaves it to the joint.
    pub x: Option<[f64; 3]>,
}

/// A place with axes on the ground: `[ground.markers.MARKER]`.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundMarker {
    /// Its name, as [`Marker::name`].
    pub name: String,
    /// Its place, length, global.
    pub at: [f64; 3],
    /// Its axes, global; `None` leaves them to the joint.
    pub axes: Option<MarkerAxes>,
}
