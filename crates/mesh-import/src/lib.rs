#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

mod beside;
mod contents;
mod deck_material;
mod error;
mod foreign;
mod format;
mod imported;
mod included;
mod mesh_file;
mod own;
mod reader;
mod settings;

use std::path::Path;

pub use beside::{Beside, DeckMass, DeckTie, Elastic};
pub use deck_material::DeckMaterial;
pub use error::ImportError;
pub use imported::Imported;
pub use included::files_of_mesh;
pub use mesh_file::MeshFile;
pub use reader::{Reader, reader_of};
pub use settings::ImportSettings;

/// Reads a mesh of any format.
///
/// # Errors
/// [`ImportError`]: the file cannot be read, no program is there to read it, or it is not a mesh of second-order tetrahedra.
pub fn read_mesh(path: &Path, settings: &ImportSettings) -> Result<Imported, ImportError> {
    MeshFile::read(path, settings)?.mesh()
}
