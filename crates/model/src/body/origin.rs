//! Origin of a body file, as a text in the file.

use std::collections::BTreeMap;

use fem_tet10::{Material, Materials, PointMass};
use scene::{MeshedBody, TiedMass};
use sealed::{SealedError, SealedFile};
use serde::{Deserialize, Serialize};

/// Name of this text in the file.
pub(crate) const ORIGIN: &str = "origin";

/// Origin of a body file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Origin {
    /// The version of flexframe that made it.
    pub program_version: String,
    /// The name of the mesh file.
    pub mesh: String,
    /// BLAKE3 of the mesh file, in hexadecimal digits.
    pub mesh_hash: String,
    #[serde(flatten)]
    pub elements: ElementKeys,
    /// How many modes were searched for.
    pub modes: usize,
    /// The key of the support, in hexadecimal digits.
    pub support: String,
    /// The hash of the displacements of the bent body that the modes are about, in hexadecimal digits; none about the undeformed
    /// one.
    #[serde(default)]
    pub reference: Option<String>,
}

/// Materials and point masses, by their keys in a scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct ElementKeys {
    material: Option<Material>,
    /// By group, where there is no one material.
    materials: BTreeMap<String, Material>,
    pub point_masses: Vec<PointMass>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tied_masses: Vec<TiedMass>,
}

impl Origin {
    /// The origin of a file.
    ///
    /// # Errors
    /// [`SealedError::Damaged`] where it has none.
    pub fn read(file: &SealedFile) -> Result<Self, SealedError> {
        let text = file.text(ORIGIN).and_then(|text| serde_json::from_str(text).ok());
        text.ok_or_else(|| file.damaged("it does not say what it was made of"))
    }

    pub fn to_json(&self) -> String {
        // All its keys are texts: it cannot fail.
        serde_json::to_string(self).unwrap_or_default()
    }
}

impl ElementKeys {
    pub fn of(body: &MeshedBody) -> Self {
        let (material, materials) = match &body.materials {
            Materials::Uniform(material) => (Some(*material), BTreeMap::new()),
            Materials::ByGroup(materials) => (None, materials.clone()),
        };
        Self { material, materials, point_masses: body.point_masses.clone(), tied_masses: body.tied_masses.clone() }
    }

    pub fn materials(&self) -> Materials {
        match self.material {
            Some(material) => Materials::Uniform(material),
            None => Materials::ByGroup(self.materials.clone()),
        }
    }

    /// Numbers are what they are to the last bit.
    pub fn to_json(&self) -> String {
        serde_json::to_string(self).unwrap_or_default()
    }
}
