//! What holds a body, and the rigid motions that it has left.

use nalgebra::Vector3;

/// The rigid motions of a body that what holds it leaves free.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RigidMotion {
    /// Nothing holds the body: three translations and three rotations.
    Free,
    /// Three rotations about a point, mesh axes.
    Pin {
        /// The point.
        point: Vector3<f64>,
    },
    /// A rotation about an axis, mesh axes.
    Hinge {
        /// A point of the axis.
        point: Vector3<f64>,
        /// Its direction, a unit vector.
        axis: Vector3<f64>,
    },
    /// A translation, mesh axes.
    Slider {
        /// Its direction, a unit vector.
        direction: Vector3<f64>,
    },
    /// None: the body can only deform.
    Clamp {
        /// The point that positions are measured from, e.g. a point of the axis that the clamp is turned about.
        origin: Vector3<f64>,
    },
}

/// How a body is held: the nodes that move with the support, and the motions that the support has.
///
/// A held node moves as the support does, i.e. as one of the rigid motions of [`Support::motion`] takes it along; a
/// node on the axis of a hinge or at the point of a pin does not move at all.
#[derive(Debug, Clone, PartialEq)]
pub struct Support {
    /// The rigid motions left.
    pub motion: RigidMotion,
    /// Indices of the nodes that are held.
    pub nodes: Vec<u32>,
}

impl Support {
    /// Of a body that nothing holds.
    pub fn free() -> Self {
        Self { motion: RigidMotion::Free, nodes: Vec::new() }
    }
}

impl RigidMotion {
    /// Number of rigid modes: 6, 3, 1, 1 or 0.
    pub fn count(&self) -> usize {
        match self {
            Self::Free => 6,
            Self::Pin { .. } => 3,
            Self::Hinge { .. } | Self::Slider { .. } => 1,
            Self::Clamp { .. } => 0,
        }
    }
}
