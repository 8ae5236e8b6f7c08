//! The finite-element model of a scene.

use dynamics::Drive;
use fem_tet10::Mesh;
use modal::Support;

use crate::load::mesh_load::MeshLoad;
use crate::needs::Needed;
use crate::reduction::reference::Reference;
use crate::structure::Structure;
use crate::tie::mesh_marker::MeshMarker;

/// The finite-element model of a scene: what modes, static responses and the reduced body are made from.
pub(crate) struct MeshModel<'a, 's> {
    pub scene: &'a Needed<'a>,
    pub mesh: &'a Mesh,
    /// The nodes of the body that the modes are about.
    pub positions: &'a [[f64; 3]],
    /// The bent body that they are about.
    pub reference: Option<&'a Reference>,
    /// Degrees of freedom of a node: 3, or 6 with its rotations.
    pub dofs: usize,
    pub structure: &'a Structure<'s>,
    pub support: &'a Support,
    /// Loads that may act.
    pub loads: Vec<MeshLoad>,
    pub markers: Vec<MeshMarker>,
    pub drive: Option<Drive>,
}
