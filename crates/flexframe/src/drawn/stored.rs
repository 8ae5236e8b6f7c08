//! What a results file has of its body: the shapes on the surface, as long as they are not too large for it.

use std::path::Path;

use fem_tet10::AssemblyError;
use memory::Bytes;
use model::Model;
use results::{MeshProperties, Shapes};
use scene::{Body, Scene};

use super::hash;
use super::of_model::{surface, surface_shapes_of};
use crate::files::results_path::results_path;
use crate::files::scene_file;

/// Shapes of more bytes stay in the body file.
const MAX_BYTES: u64 = 256_000_000;

/// The shapes that the results file of a run carries: none of a rigid body without a mesh, nor those that are too large.
///
/// # Errors
/// [`AssemblyError`] where the stress cannot be computed, for want of memory.
pub(crate) fn stored_shapes(model: &Model) -> Result<Option<Shapes>, AssemblyError> {
    if bytes(model) > MAX_BYTES { Ok(None) } else { surface_shapes_of(model) }
}

/// The finite-element model of a body, in the words of a results file.
pub(crate) fn mesh_properties(scene: &Scene, model: &Model) -> Option<MeshProperties> {
    let meshed = model.meshed.as_ref()?;
    let mesh = &meshed.mesh;
    let (body_file, shapes_hash) = match &scene.body {
        Body::Meshed(_) | Body::File(_) => (body_file(scene), hash::of_model(meshed)),
        // No body file is made of these.
        Body::Matrices(_) | Body::Rigid(_) => (String::new(), String::new()),
    };
    let (nodes, elements) = (mesh.positions().len(), mesh.elements().len());
    Some(MeshProperties { nodes, elements, size: mesh.size(), body_file, shapes_hash })
}

/// A warning where the results file of a run does not carry the shapes.
pub(crate) fn not_stored(scene: &Scene, model: &Model) -> Option<String> {
    let bytes = bytes(model);
    (scene.body.has_elements() && bytes > MAX_BYTES).then(|| {
        let [bytes, limit] = [bytes, MAX_BYTES].map(|bytes| Bytes(usize::try_from(bytes).unwrap_or(usize::MAX)));
        format!(
            "the shapes on the surface take {bytes}, and a results file carries {limit} of them at the most: report, animate and \
             export --vtkhdf, --vtu and --modes will read them from the body file {}{}",
            body_file(scene),
            match scene.body {
                Body::File(_) => "",
                _ => " beside the results file, which `flexframe reduce SCENE --stress -o FILE` makes",
            }
        )
    })
}

/// The body file with the shapes on all nodes: that of the scene, or one beside the results file.
fn body_file(scene: &Scene) -> String {
    match &scene.body {
        Body::File(body) => scene_file::to_text(&body.file),
        _ => results_path(scene, Path::new("")).with_extension("body.h5").to_string_lossy().into_owned(),
    }
}

/// Bytes of the shapes on the surface, but for some thousandths.
fn bytes(model: &Model) -> u64 {
    let Some(meshed) = model.meshed.as_ref().filter(|meshed| meshed.mesh.has_elements()) else { return 0 };
    let nodes = surface(&meshed.mesh).0.len() as u64;
    let shapes = (meshed.modes.shapes.ncols() + meshed.following.ncols()) as u64;
    let large = model.large_modes().len() as u64;
    8 * nodes * (9 * shapes + 3 * large * (large + 1))
}
