//! The files that a scene itself is read from.

use std::path::PathBuf;

use crate::body::constraint::Constraint;
use crate::loads::history::{History, TablePoints};
use crate::loads::load::Load;
use crate::scene::Scene;

impl Scene {
    /// The scene file, and the tables of its histories and of its measured modes: what is read to know the scene. Those of its body are read later.
    pub fn files(&self) -> Vec<PathBuf> {
        let mut files = vec![self.path.clone()];
        files.extend(self.tables().filter_map(|table| table.file.clone()));
        files.extend(self.modes.measured.iter().map(|measured| measured.file.clone()));
        files
    }

    /// The tables of its histories, with their points as they were read.
    pub fn tables(&self) -> impl Iterator<Item = &TablePoints> {
        self.histories().flat_map(tables)
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
fn tables(history: &History) -> Vec<&TablePoints> {
    match history {
        History::Table(table) => vec![table],
        History::Product { factors } => factors.iter().flat_map(tables).collect(),
        _ => Vec::new(),
    }
}
