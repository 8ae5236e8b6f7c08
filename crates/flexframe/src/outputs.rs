//! Files that the commands read, so that they do not write over them ([`whole_file::Outputs`]).

use std::path::Path;

use mesh_import::files_of_mesh;
use results::Results;
use scene::Scene;
pub use whole_file::{OutputError, Outputs, Written};

use crate::reopened::scene_in;

/// Files that a command may write that reads a scene.
pub fn outputs_of_scene(scene: &Scene, overwrite: bool) -> Outputs {
    Outputs::new(scene.files(), overwrite)
}

/// The same of one that reads a mesh or geometry.
pub fn outputs_of_mesh(mesh: &Path, overwrite: bool) -> Outputs {
    Outputs::new(files_of_mesh(mesh), overwrite)
}

/// The same of one that reads a results file, and what the scene in it names.
pub fn outputs_of_results(file: &Path, overwrite: bool) -> Outputs {
    let scene = Results::metadata_of(file).ok().and_then(|metadata| scene_in(&metadata).ok());
    let of_scene = scene.map_or_else(Vec::new, |scene| scene.files());
    Outputs::new(of_scene, overwrite).and_input(file)
}
