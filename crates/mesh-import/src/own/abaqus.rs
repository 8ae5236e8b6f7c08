//! Decks of Abaqus and CalculiX: parts, instances, sets, surfaces and materials, and what of them is not used.

mod body;
mod deck;
mod keywords;
mod kinds;
mod lines;
mod materials;
mod scope;
mod space;

use std::path::Path;

use crate::contents::ReadFile;
use crate::error::ImportError;
use crate::imported::Imported;
use crate::own::abaqus::deck::Deck;
use crate::own::abaqus::lines::blocks;
use crate::own::texts::Texts;

/// The mesh of a deck and its materials.
pub(crate) fn read(files: &[ReadFile], source: &Path, raise_order: bool) -> Result<Imported, ImportError> {
    let texts = Texts::new(files);
    let blocks = blocks(&texts)?;
    let deck = Deck::read(&texts, &blocks)?;
    body::imported(&texts, deck, source, raise_order)
}
