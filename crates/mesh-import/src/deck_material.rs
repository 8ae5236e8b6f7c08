//! Materials that a mesh file has beside the mesh.

use fem_tet10::Material;
use serde::{Deserialize, Serialize};

/// An isotropic material of a group: `*ELASTIC` and `*DENSITY` of a `*SOLID SECTION`, or the `MAT1` of a `PSOLID`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DeckMaterial {
    /// The group of the mesh.
    pub group: String,
    /// Its name in the file.
    pub name: String,
    /// Its constants, in the units of the file.
    #[serde(flatten)]
    pub material: Material,
}
