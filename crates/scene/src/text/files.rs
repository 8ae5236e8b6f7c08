//! The files that a scene itself is read from.

use std::path::PathBuf;

use crate::body::Body;
use crate::body::constraint::Constraint;
use crate::loads::history::{History, TablePoints};
use crate::scene::Scene;

impl Scene {
    /// The scene file, the tables of all histories, and those of measured modes: the files that are read to know the scene. Those
    /// of its bodies are read later.
    pub fn files(&self) -> Vec<PathBuf> {
        let tables = self.tables().filter_map(|table| table.file.clone());
        let measured = self.bodies.iter().flat_map(|body| &body.modes.measured).map(|measured| measured.file.clone());
        std::iter::once(self.path.clone()).chain(tables).chain(measured).collect()
    }

    /// The tables of the histories of its bodies and joints, with their points as they were read.
    pub fn tables(&self) -> impl Iterator<Item = &TablePoints> {
        let of_joints = self.joints.iter().flat_map(|joint| joint.drive.iter().chain(&joint.motor));
        let of_bodies = self.bodies.iter().flat_map(Body::histories);
        of_bodies.chain(of_joints.map(|drive| &drive.history)).flat_map(tables_of)
    }
}

impl Body {
    /// The histories of the loads and of what drives the body.
    fn histories(&self) -> impl Iterator<Item = &History> {
        let of_loads = self.loads.iter().map(|load| &load.history);
        let driven = self.constraint.as_ref().and_then(Constraint::motion);
        of_loads.chain(driven.map(|motion| &motion.history))
    }
}

/// The tables of a history.
pub fn tables_of(history: &History) -> Vec<&TablePoints> {
    match history {
        History::Table(table) => vec![table],
        History::Product { factors } => factors.iter().flat_map(tables_of).collect(),
        _ => Vec::new(),
    }
}
