//! The files that a body is read from.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use mesh_import::files_of_mesh;
use scene::{BodySource, Scene};
use slepc::Slepc;

use crate::building::builder::Builder;

impl Builder {
    /// All files that the models and the motion of a scene are read from, each once: the scene file, the tables of histories of
    /// bodies and joints and of measured modes, the files of the bodies, those that a mesh or geometry may include, and those
    /// that SLEPc has left in a folder.
    pub fn files(&self, scene: &Scene) -> Vec<PathBuf> {
        let of_bodies = scene.bodies.iter().flat_map(|body| files_of_body(&body.source));
        let files = scene.files().into_iter().chain(of_bodies);
        let mut known = BTreeSet::new();
        files.chain(self.solver.iter().flat_map(Slepc::files)).filter(|file| known.insert(file.clone())).collect()
    }
}

/// The files of a body, and what a mesh or geometry may include.
pub fn files_of_body(body: &BodySource) -> Vec<PathBuf> {
    match body {
        BodySource::Meshed(body) => files_of_mesh(&body.mesh),
        BodySource::File(_) | BodySource::Matrices(_) | BodySource::Rigid(_) => {
            body.files().into_iter().map(Path::to_owned).collect()
        }
    }
}
