//! The files that a body is read from.

use std::path::PathBuf;

use mesh_import::files_of_mesh;
use scene::{Body, FileBody, Scene};
use slepc::Slepc;

use crate::building::builder::Builder;

impl Builder {
    /// The files that the model of a scene is read from: the scene file and the tables of its histories, those of the body, what
    /// a mesh or geometry may include, and what SLEPc has left in a folder.
    pub fn files(&self, scene: &Scene) -> Vec<PathBuf> {
        let mut files = scene.files();
        files.extend(files_of_body(&scene.body));
        files.extend(self.solver.iter().flat_map(Slepc::files));
        files
    }
}

/// The files of a body, and what a mesh or geometry may include.
pub fn files_of_body(body: &Body) -> Vec<PathBuf> {
    match body {
        Body::File(FileBody { file, .. }) => vec![file.clone()],
        Body::Meshed(body) => files_of_mesh(&body.mesh),
        Body::Matrices(matrices) => matrices.list().map(|(_, path)| path.to_owned()).collect(),
        Body::Rigid(_) => Vec::new(),
    }
}
