//! The shapes on the surfaces of bodies in a results file, as long as they are not too large for it.

use fem_tet10::AssemblyError;
use memory::Bytes;
use model::Model;
use results::{MeshProperties, Shapes};
use scene::{Body, BodySource};

use super::hash;
use super::of_model::{surface, surface_shapes_of};
use crate::commands::run::RunBody;
use crate::files::results_path::body_file_name;
use crate::files::scene_file;

/// Shapes of more bytes stay in the body file; of several bodies each may have its share of them.
const MAX_BYTES: u64 = 256_000_000;

/// The shapes that the results file of a run carries of each body, unless they are too large.
///
/// # Errors
/// [`AssemblyError`] where the stress cannot be computed, for want of memory.
pub(crate) fn stored_shapes(bodies: &[RunBody<'_>]) -> Result<Vec<Option<Shapes>>, AssemblyError> {
    let fits = |model: &Model| bytes(model) <= share(bodies.len());
    bodies
        .iter()
        .map(|body| if fits(body.model) { surface_shapes_of(body.model).map(Some) } else { Ok(None) })
        .collect()
}

/// Bytes of the shapes that the results file of a run carries.
pub(crate) fn stored_bytes(bodies: &[RunBody<'_>]) -> u64 {
    let each = bodies.iter().map(|body| bytes(body.model));
    each.filter(|bytes| *bytes <= share(bodies.len())).sum()
}

/// Bytes that a body may have of a file of several.
fn share(bodies: usize) -> u64 {
    MAX_BYTES / (bodies.max(1) as u64)
}

/// The finite-element model of a body, in the words of a results file.
pub(crate) fn mesh_properties(body: &Body, model: &Model) -> Option<MeshProperties> {
    let meshed = model.meshed.as_ref()?;
    let mesh = &meshed.mesh;
    let (body_file, shapes_hash) = match &body.source {
        BodySource::Meshed(_) | BodySource::File(_) => (body_file(body), hash::of_model(meshed)),
        // No body file is made of these.
        BodySource::Matrices(_) | BodySource::Rigid(_) => (String::new(), String::new()),
    };
    let (nodes, elements) = (mesh.positions().len(), mesh.elements().len());
    Some(MeshProperties { nodes, elements, size: mesh.size(), body_file, shapes_hash })
}

/// A warning where the results file of a run does not carry the shapes.
pub(crate) fn not_stored(RunBody { body, model }: RunBody<'_>, bodies: usize) -> Option<String> {
    let (bytes, limit) = (bytes(model), share(bodies));
    (body.source.has_elements() && bytes > limit).then(|| {
        let [bytes, limit] = [bytes, limit].map(|bytes| Bytes(usize::try_from(bytes).unwrap_or(usize::MAX)));
        format!(
            "the shapes on the surface take {bytes}, and a results file carries {limit} of them at the most: report, animate and \
             export --vtkhdf, --vtu and --modes will read them from the body file {}{}",
            body_file(body),
            match body.source {
                BodySource::File(_) => "",
                _ => " beside the results file, which `flexframe reduce SCENE --stress -o FILE` makes",
            }
        )
    })
}

/// The body file with the shapes on all nodes: that of the scene, or one beside the results file.
fn body_file(body: &Body) -> String {
    match &body.source {
        BodySource::File(given) => scene_file::to_text(&given.file),
        _ => body_file_name(body).to_string_lossy().into_owned(),
    }
}

/// Bytes of the shapes on the surface, in single precision, with its nodes and faces.
fn bytes(model: &Model) -> u64 {
    let Some(meshed) = model.meshed.as_ref().filter(|meshed| meshed.mesh.has_elements()) else { return 0 };
    let (nodes, faces) = surface(&meshed.mesh);
    let [nodes, faces] = [nodes.len(), faces.len()].map(|count| count as u64);
    let shapes = (meshed.modes.shapes.ncols() + meshed.following.ncols()) as u64;
    let products = model.physics.large_deflection.as_ref().map_or(0, |manifold| manifold.products().len()) as u64;
    4 * nodes * (9 * shapes + 6 * products) + nodes * (4 + 4 + 24) + faces * 24
}
