//! The mesh of a scene and its matrices.

use fem_tet10::{AssemblyError, Matrices, Mesh, MeshError, assemble};
use mesh_import::{ImportError, ImportSettings, Imported, MeshFile};

use super::error::{BuildError, refuse};
use crate::scene::{MeshedBody, Scene};
use crate::shorten::shorten;

/// The mesh file of a body, as it is now.
pub(super) fn mesh_file(scene: &Scene, body: &MeshedBody) -> Result<MeshFile, BuildError> {
    let trust_geometry = body.import.trust_geometry || scene.cache.trusts_geometry();
    let settings = ImportSettings { trust_geometry, ..body.import };
    MeshFile::read(&body.mesh, &settings).map_err(refused(scene))
}

/// The mesh in that file.
pub(super) fn mesh_in(scene: &Scene, file: &MeshFile) -> Result<Imported, BuildError> {
    if let Some(remark) = file.remark() {
        scene.cache.warn(remark);
    }
    file.mesh().map_err(refused(scene))
}

fn refused(scene: &Scene) -> impl Fn(ImportError) -> BuildError {
    |error| match error {
        ImportError::Mesh(MeshError::Io { source_name, source: cause }) | ImportError::Io { source_name, cause } => {
            scene
                .refuse(
                    "body.mesh",
                    format!("a mesh that cannot be read: {}: {cause}", shorten(&source_name)),
                    "a mesh file, its path relative to the folder of the scene file",
                    "correct the path, or make the mesh: gmsh -3 -order 2 -format msh41 BODY.geo",
                )
                .into()
        }
        ImportError::Mesh(error) => BuildError::from(error),
        other => Box::new(other).into(),
    }
}

pub(super) fn matrices(scene: &Scene, body: &MeshedBody, mesh: &Mesh) -> Result<Matrices, BuildError> {
    assemble(mesh, &body.materials, &body.point_masses).map_err(|error| {
        let at = match &error {
            AssemblyError::OffBody { at, .. } | AssemblyError::Spread { at, .. } => *at,
            AssemblyError::MissingGroup { group, .. } => {
                let key = format!("body.materials.{group}");
                return refuse(scene, &key, error).into();
            }
            _ => return error.into(),
        };
        match body.point_masses.iter().position(|p| p.at == at) {
            Some(i) => refuse(scene, &format!("body.point_masses[{i}].at"), error).into(),
            None => error.into(),
        }
    })
}
