//! Decks of Nastran and OptiStruct: nodes in their coordinate systems, tetrahedra and materials, and what of them is not used.

mod body;
mod card;
mod cards;
mod kinds;
mod masses;
mod replication;
mod sections;
mod systems;

use std::path::Path;

use crate::contents::ReadFile;
use crate::error::ImportError;
use crate::imported::Imported;
use crate::own::texts::Texts;

pub(crate) use cards::is_include;

/// The mesh of a deck and its materials.
pub(crate) fn read(files: &[ReadFile], source: &Path, raise_order: bool) -> Result<Imported, ImportError> {
    let texts = Texts::without_tabs(files);
    let bulk = cards::cards(&texts)?;
    body::imported(&texts, &bulk, source, raise_order)
}
