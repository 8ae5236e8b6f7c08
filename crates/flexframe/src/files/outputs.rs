//! Files that the commands read, so that they do not write over them ([`whole_file::Outputs`]).

use std::path::Path;

use mesh_import::files_of_mesh;
use model::Builder;
use results::Results;
use scene::{Body, Scene};
pub use whole_file::{OutputError, Outputs, Written};

use crate::drawn::body_files;
use crate::files::scene_file;

/// Files that a command may write that builds a scene.
pub fn outputs_of_body(body: &Body, builder: &Builder, overwrite: bool) -> Outputs {
    outputs_of_scene(&body.clone().into(), builder, overwrite)
}

/// The same of one that builds the bodies and joints of a scene.
pub fn outputs_of_scene(scene: &Scene, builder: &Builder, overwrite: bool) -> Outputs {
    Outputs::new(builder.files(scene), overwrite)
}

/// The same of one that reads a mesh or geometry.
pub fn outputs_of_mesh(mesh: &Path, overwrite: bool) -> Outputs {
    Outputs::new(files_of_mesh(mesh), overwrite)
}

/// The same of one that reads a results file; it spares the body file, and what the run read.
pub fn outputs_of_results(file: &Path, overwrite: bool) -> Outputs {
    let mut inputs = Vec::new();
    if let Ok(metadata) = Results::metadata_of(file) {
        inputs.extend(metadata.input_files.iter().map(|text| scene_file::to_path(text)));
        let meshes = metadata.bodies.iter().filter_map(|body| body.model.mesh.as_ref());
        inputs.extend(meshes.flat_map(|mesh| body_files(file, mesh)));
    }
    Outputs::new(inputs, overwrite).and_input(file)
}
