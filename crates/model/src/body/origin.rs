//! Origin of a body file, as a text in the file.

use std::collections::BTreeMap;

use body_file::{BodyFile, BodyFileError};
use fem_tet10::{Material, Materials, PointMass};
use serde::{Deserialize, Serialize};

/// Name of this text in the file.
pub(crate) const ORIGIN: &str = "origin";

/// Origin of a body file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Origin {
    /// The version of flexframe that made it.
    pub program_version: String,
    /// The name of the mesh file.
    pub mesh: String,
    /// BLAKE3 of the mesh file, in hexadecimal digits.
    pub mesh_hash: String,
    pub material: Option<Material>,
    /// By group, where there is no one material.
    pub materials: BTreeMap<String, Material>,
    pub point_masses: Vec<PointMass>,
    /// How many modes were searched for.
    pub modes: usize,
    /// The support.
    pub support: String,
}

impl Origin {
    /// The origin of a file.
    ///
    /// # Errors
    /// [`BodyFileError::Damaged`] where it has none.
    pub fn read(file: &BodyFile) -> Result<Self, BodyFileError> {
        let text = file.attribute(ORIGIN).and_then(|text| serde_json::from_str(text).ok());
        text.ok_or_else(|| BodyFileError::Damaged {
            path: file.path().to_owned(),
            what: "it does not say what it was made of".to_owned(),
        })
    }

    pub fn to_json(&self) -> String {
        // All its keys are texts: it cannot fail.
        serde_json::to_string(self).unwrap_or_default()
    }

    pub fn materials(&self) -> Materials {
        match self.material {
            Some(material) => Materials::Uniform(material),
            None => Materials::ByGroup(self.materials.clone()),
        }
    }
}
