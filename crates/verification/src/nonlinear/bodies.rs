//! Bodies that comparisons are made on: the mesh of each is a file, which scenes read too.

use std::path::{Path, PathBuf};

use fem_tet10::{Material, Mesh, read_msh};

use crate::nonlinear::error::SolidError;

/// The material of the soft bodies, SI.
pub const SOFT: Material = Material { young_modulus: 1e7, poisson_ratio: 0.3, density: 1000.0 };

/// Material of the slender column, without Poisson's ratio: the clamp of a beam does not hinder it.
pub const COLUMN: Material = Material { young_modulus: 7e7, poisson_ratio: 0.0, density: 1000.0 };

/// E I of the column, whose length is 1 and whose breadth is 0.025.
pub const COLUMN_BENDING: f64 = COLUMN.young_modulus * 0.025 * 0.025 * 0.025 * 0.025 / 12.0;

/// The path of a mesh.
pub fn mesh_path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("meshes").join(format!("{name}.msh"))
}

/// A mesh by its name.
///
/// # Errors
/// Errors of the file.
pub fn mesh(name: &str) -> Result<Mesh, SolidError> {
    Ok(read_msh(mesh_path(name))?)
}

/// [`SOFT`] with another modulus.
pub fn soft(young_modulus: f64) -> Material {
    Material { young_modulus, ..SOFT }
}
