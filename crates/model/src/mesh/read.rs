//! The mesh of a scene and its matrices.

use fem_tet10::{AssemblyFault, Matrices, Mesh, MeshError, MeshFault, assemble};
use std::path::Path;

use mesh_import::{ImportError, ImportSettings, Imported, MeshFile, Reader, reader_of};
use modal::TiedPoint;
use scene::{Body, MeshedBody, SceneError, TiedMass, shorten};
use whole_file::is_of_temporaries;

use crate::building::builder::Builder;
use crate::error::{BuildError, refuse, refuse_mesh};

/// How a mesh file is read.
pub(crate) fn import_settings(builder: &Builder, mesh_size: Option<f64>, raise_order: bool) -> ImportSettings {
    ImportSettings { mesh_size, raise_order, trust_geometry: builder.trust_geometry, hides_lines: true }
}

/// The mesh file of a body, as it is now.
pub(crate) fn mesh_file(builder: &Builder, body: &Body, meshed: &MeshedBody) -> Result<MeshFile, BuildError> {
    let settings = import_settings(builder, meshed.mesh_size, meshed.raise_order);
    mesh_file_at(body, &meshed.mesh, &settings)?.map_err(refused(body))
}

/// The same at a place; a size is refused for what is no geometry.
pub(crate) fn mesh_file_at(
    body: &Body,
    mesh: &Path,
    settings: &ImportSettings,
) -> Result<Result<MeshFile, ImportError>, SceneError> {
    if settings.mesh_size.is_some() && reader_of(mesh, settings) != Reader::GmshMesher {
        return Err(body.refuse(
            "body.mesh_size",
            "a size for a mesh that is there",
            "geometry to be meshed: a .geo, STEP, IGES or BREP file",
            "remove it, or mesh again with elements of this size",
        ));
    }
    Ok(MeshFile::read(mesh, settings))
}

/// The mesh in that file.
pub(crate) fn mesh_in(builder: &Builder, body: &Body, file: &MeshFile) -> Result<Imported, BuildError> {
    if let Some(remark) = file.remark() {
        builder.cache.warn(remark);
    }
    file.mesh().map_err(refused(body))
}

fn refused(body: &Body) -> impl Fn(ImportError) -> BuildError {
    |error| match error {
        // What a temporary folder lacks is not the scene's to mend.
        ImportError::Io { source_name, cause } if is_of_temporaries(&cause) => {
            Box::new(ImportError::Io { source_name, cause }).into()
        }
        ImportError::Mesh(MeshError { mesh, fault: MeshFault::Io(cause), .. })
        | ImportError::Io { source_name: mesh, cause } => body
            .refuse(
                "body.mesh",
                format!("a mesh that cannot be read: {}: {cause}", shorten(&mesh)),
                "a mesh file, its path relative to the folder of the scene file",
                "correct the path, or make the mesh: gmsh -3 -order 2 -format msh41 BODY.geo",
            )
            .into(),
        ImportError::Mesh(error) => BuildError::from(error),
        other => Box::new(other).into(),
    }
}

pub(crate) fn matrices(body: &Body, meshed: &MeshedBody, mesh: &Mesh) -> Result<Matrices, BuildError> {
    assemble(mesh, &meshed.materials, &meshed.point_masses).map_err(|error| {
        let at = match &error.fault {
            AssemblyFault::OffBody { at, .. } | AssemblyFault::Spread { at, .. } => *at,
            AssemblyFault::MissingGroup { group, .. } => {
                let key = format!("body.materials.{group}");
                return refuse(body, &key, error).into();
            }
            _ => return error.into(),
        };
        match meshed.point_masses.iter().position(|p| p.at == at) {
            Some(i) => refuse(body, &format!("body.point_masses[{i}].at"), error).into(),
            None => error.into(),
        }
    })
}

/// The masses of a scene that move with nodes of its mesh.
pub(crate) fn tied_points(body: &Body, meshed: &MeshedBody, mesh: &Mesh) -> Result<Vec<TiedPoint>, BuildError> {
    let point = |(i, tied): (usize, &TiedMass)| {
        let key = format!("body.tied_masses[{i}].group");
        let nodes = mesh.group_nodes(&tied.group).map_err(|error| refuse_mesh(body, &key, &error))?;
        let count = nodes.len();
        if count > MAX_CARRIERS {
            let help = "name a smaller part, or give the mass a `spread` in `point_masses`";
            let expected = format!("at most {MAX_CARRIERS}, each of which is coupled to all others");
            return Err(body.refuse(&key, format!("{count} nodes that carry one mass"), expected, help).into());
        }
        TiedPoint::new(tied.mass, tied.at, nodes, mesh.positions()).ok_or_else(|| {
            let found = format!("{count} node(s) that do not tell how the point turns with them");
            let help = "give three nodes or more that are not on a line, or put the mass on the body: `point_masses`";
            body.refuse(&key, found, "nodes that a rigid motion is told by", help).into()
        })
    };
    meshed.tied_masses.iter().enumerate().map(point).collect()
}

/// Most nodes that carry one mass.
const MAX_CARRIERS: usize = 500;
