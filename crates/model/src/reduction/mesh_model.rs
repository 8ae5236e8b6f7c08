//! The finite-element model of a scene.

use dynamics::Drive;
use faer::Mat;
use fem_tet10::Mesh;
use modal::{Modes, Support};
use scene::Scene;

use crate::load::mesh_load::MeshLoad;
use crate::structure::Structure;

/// The finite-element model of a scene: what modes, static responses and the reduced body are made from.
pub(crate) struct MeshModel<'a> {
    pub scene: &'a Scene,
    pub mesh: &'a Mesh,
    /// Degrees of freedom of a node: 3, or 6 with its rotations.
    pub dofs: usize,
    pub solver: &'a dyn Structure,
    pub support: &'a Support,
    /// Loads that may act.
    pub loads: Vec<MeshLoad>,
    pub drive: Option<Drive>,
}

/// The shapes (3n×k) of some modes, numbered from 0.
pub(crate) fn shapes_of(modes: &Modes, list: &[usize]) -> Mat<f64> {
    Mat::from_fn(modes.shapes.nrows(), list.len(), |i, j| modes.shapes[(i, list[j])])
}
