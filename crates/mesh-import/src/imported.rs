//! A mesh of a file, with what goes with it.

use fem_tet10::Mesh;

use crate::beside::Beside;
use crate::deck_material::DeckMaterial;

/// A mesh, and what of its file was left out, in sentences.
#[derive(Debug)]
pub struct Imported {
    /// The mesh, with the name of its own file.
    pub mesh: Mesh,
    /// Such as "the element set A has no tetrahedra and no triangles".
    pub notes: Vec<String>,
    /// The materials that the file gives to groups of the mesh, in its own units.
    pub materials: Vec<DeckMaterial>,
    /// Masses, ties and elasticities of the file, which a scene can have. No note tells of its masses: see [`Beside::unused_masses`].
    pub beside: Beside,
}
