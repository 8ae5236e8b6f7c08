#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

mod error;
mod reader;
mod run;
mod settings;

use std::path::Path;

use body_file::{Digest, Hash};
use fem_tet10::{Mesh, parse_msh, read_msh};

pub use error::ImportError;
pub use reader::{Reader, reader_of};
pub use settings::ImportSettings;

/// A mesh, and what of its file was left out, in sentences.
#[derive(Debug)]
pub struct Imported {
    /// The mesh, with the name of its own file.
    pub mesh: Mesh,
    /// Such as "the element set A has no tetrahedra and no triangles".
    pub notes: Vec<String>,
}

/// Reads a mesh of any format.
///
/// # Errors
/// [`ImportError`]: the file cannot be read, no program is there to read it, or it is not a mesh of second-order tetrahedra.
pub fn read_mesh(path: &Path, settings: &ImportSettings) -> Result<Imported, ImportError> {
    let reader = reader_of(path, settings);
    if reader == Reader::Own {
        return Ok(Imported { mesh: read_msh(path)?, notes: Vec::new() });
    }
    let source_name = path.display().to_string();
    let io = |cause| ImportError::Io { source_name: source_name.clone(), cause };
    // What the programs say of a file that is not there is said worse.
    if let Err(error) = std::fs::File::open(path) {
        return Err(io(error));
    }
    let folder = tempfile::tempdir().map_err(io)?;
    let target = folder.path().join("mesh.msh");
    let notes = match reader {
        Reader::Own => Vec::new(),
        Reader::GmshMesher => run::gmsh(path, &target, settings, true)?,
        Reader::GmshConverter => run::gmsh(path, &target, settings, false)?,
        Reader::Meshio => run::meshio(path, &target, settings)?,
    };
    let bytes = std::fs::read(&target).map_err(io)?;
    Ok(Imported { mesh: parse_msh(&bytes, &source_name)?, notes })
}

/// What a mesh follows from: its file, and how it is read. `None` where the file cannot be read or includes others.
pub fn hash_of_mesh(path: &Path, settings: &ImportSettings) -> Option<Hash> {
    // What is no ordinary file can be read only once.
    let file = Some(path).filter(|path| path.is_file()).and_then(|path| Hash::of_file(path).ok())?;
    match reader_of(path, settings) {
        Reader::Own => Some(file),
        _ if reader::includes_others(path) => None,
        reader => Some(Digest::new().hash(&file).text(&format!("{reader:?} {settings:?}")).finish()),
    }
}
