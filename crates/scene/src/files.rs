//! The files that a scene is read from.

use std::path::{Path, PathBuf};

use mesh_import::files_of_mesh;
use slepc::Slepc;

use crate::constraint::Constraint;
use crate::history::History;
use crate::load::Load;
use crate::scene::{Body, MeshedBody, Scene};

impl Body {
    /// The files that it is read from, and what a mesh or geometry may include.
    pub fn files(&self) -> Vec<PathBuf> {
        match self {
            Self::Meshed(MeshedBody { file: Some(file), .. }) => vec![file.clone()],
            Self::Meshed(body) => files_of_mesh(&body.mesh),
            Self::Matrices(matrices) => matrices.list().map(|(_, path)| path.to_owned()).collect(),
            Self::Rigid(_) => Vec::new(),
        }
    }
}

impl Scene {
    /// The scene file and all files that it names: those of the body, what a mesh or geometry may include, the tables of
    /// histories, and what SLEPc has left in a folder.
    pub fn files(&self) -> Vec<PathBuf> {
        let mut files = vec![self.path.clone()];
        files.extend(self.body.files());
        files.extend(self.histories().flat_map(tables).map(Path::to_owned));
        files.extend(self.solver.iter().flat_map(Slepc::files));
        files
    }

    /// The histories of the loads and of what drives the body.
    fn histories(&self) -> impl Iterator<Item = &History> {
        let of_loads = self.loads.iter().map(|load| match load {
            Load::Force(load) => &load.history,
            Load::Moment(load) => &load.history,
            Load::Pressure(load) => &load.history,
            Load::Traction(load) => &load.history,
            Load::Gravity(load) => &load.history,
            Load::BaseAcceleration(load) => &load.history,
        });
        let driven = match &self.constraint {
            Some(Constraint::Hinge { motion, .. } | Constraint::Slider { motion, .. }) => motion.as_ref(),
            _ => None,
        };
        of_loads.chain(driven.map(|motion| &motion.history))
    }
}

/// The tables of a history.
fn tables(history: &History) -> Vec<&Path> {
    match history {
        History::Table(table) => table.file.iter().map(PathBuf::as_path).collect(),
        History::Product { factors } => factors.iter().flat_map(tables).collect(),
        _ => Vec::new(),
    }
}
