//! The body of a scene that comes from a body file.

use fem_tet10::Materials;
use scene::{Body, FileBody, MeshedBody, SceneError};
use sealed::{Format, SealedFile};

use crate::body::origin::Origin;
use crate::building::builder::Builder;
use crate::error::BuildError;
use crate::mesh::read::{import_settings, mesh_file_at};

const KEY: &str = "body.file";
const HELP: &str = "make the file again: flexframe reduce SCENE -o FILE, from a scene without `file`";

/// The body file of a scene, and the body that it was made of. What the scene says besides must be the same.
pub(crate) fn read_body_file(
    builder: &Builder,
    body: &Body,
    given: &FileBody,
) -> Result<(SealedFile, MeshedBody), BuildError> {
    let refuse = |found: String, expected: &str| -> SceneError { body.refuse(KEY, found, expected, HELP) };
    let opened = SealedFile::open(&given.file, Format::BODY).and_then(|file| Ok((Origin::read(&file)?, file)));
    let (origin, file) =
        opened.map_err(|error| refuse(error.to_string(), "a body file that flexframe reduce has made"))?;
    if origin.program_version != env!("CARGO_PKG_VERSION") {
        let found = format!("a body file of flexframe {}", origin.program_version);
        return Err(refuse(found, concat!("one of flexframe ", env!("CARGO_PKG_VERSION"))).into());
    }
    let FileBody { file: _, mesh, mesh_size, raise_order, materials, point_masses } = given;
    if let Some(mesh) = mesh {
        let settings = import_settings(builder, *mesh_size, *raise_order);
        // The file does without the mesh.
        if let Some(hash) = mesh_file_at(body, mesh, &settings)?.ok().and_then(|file| file.hash())
            && hash.to_string() != origin.mesh_hash
        {
            let found = "a body file that was made of another mesh".to_owned();
            return Err(refuse(found, "one of the mesh of the scene").into());
        }
    }
    let of_file: Materials = origin.elements.materials();
    if materials.as_ref().is_some_and(|materials| *materials != of_file) {
        let found = format!("a body file of another material: {of_file:?}");
        return Err(refuse(found, "one of the materials of the scene").into());
    }
    if point_masses.as_ref().is_some_and(|masses| *masses != origin.elements.point_masses) {
        let found = format!("a body file with other point masses ({} of them)", origin.elements.point_masses.len());
        return Err(refuse(found, "one of the point masses of the scene").into());
    }
    let body = MeshedBody {
        mesh: origin.mesh.into(),
        mesh_size: *mesh_size,
        raise_order: *raise_order,
        materials: of_file,
        point_masses: origin.elements.point_masses,
        tied_masses: origin.elements.tied_masses,
    };
    Ok((file, body))
}
