//! How a body is held.

use keys::{Key, Keyed};
use reduced_body::RigidMotion;

/// How a body is held: the nodes and degrees of freedom that move with the support, and the motions that the support has.
///
/// A held node moves as the support does, i.e. as one of the rigid motions of [`Support::motion`] takes it along; a
/// node on the axis of a hinge or at the point of a pin does not move at all. The same holds for single degrees of freedom:
/// none of the motions that they leave moves them.
#[derive(Debug, Clone, PartialEq)]
pub struct Support {
    /// The rigid motions left.
    pub motion: RigidMotion,
    /// Indices of the nodes that are held in all their degrees of freedom.
    pub nodes: Vec<u32>,
    /// Single degrees of freedom that are held, as pairs of a node and 0 to 2 for its translation along x, y or z, 3 to 5
    /// for its rotation.
    pub dofs: Vec<(u32, usize)>,
}

impl Support {
    /// The support of a free body.
    pub fn free() -> Self {
        Self::new(RigidMotion::free(), Vec::new())
    }

    /// The support of nodes with these indices, which move as the `motion` takes them along.
    pub fn new(motion: RigidMotion, nodes: Vec<u32>) -> Self {
        Self { motion, nodes, dofs: Vec::new() }
    }
}

impl Keyed for Support {
    fn key(&self, key: Key) -> Key {
        let dofs: Vec<usize> = self.dofs.iter().flat_map(|(node, dof)| [*node as usize, *dof]).collect();
        key.of("support", 1).with("motion", &self.motion).with("nodes", &self.nodes).with("dofs", &dofs)
    }
}
