//! Bodies that comparisons are made on: the mesh of each is a file, which scenes read too.

use std::path::{Path, PathBuf};

use fem_tet10::{Material, Mesh, read_msh};

use crate::error::NonlinearError;

/// The material of the soft bodies, SI.
pub const SOFT: Material = Material { young_modulus: 1e7, poisson_ratio: 0.3, density: 1000.0 };

/// The path of a mesh.
pub fn mesh_path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("meshes").join(format!("{name}.msh"))
}

/// A mesh by its name.
///
/// # Errors
/// What the file is refused with.
pub fn mesh(name: &str) -> Result<Mesh, NonlinearError> {
    Ok(read_msh(mesh_path(name))?)
}
