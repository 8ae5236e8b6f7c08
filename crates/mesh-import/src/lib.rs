#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

mod copy;
mod error;
mod format;
mod geometry;
mod gmsh_errors;
mod reader;
mod run;
mod settings;

use std::path::Path;

use body_file::{Digest, Hash};
use fem_tet10::{Mesh, MeshError, parse_msh, read_msh};
use whole_file::TemporaryFolder;

pub use error::ImportError;
pub use reader::{Reader, reader_of};
pub use settings::ImportSettings;

use run::GmshTask;

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
    let source_name = path.display().to_string();
    if reader == Reader::Own {
        let refused = |found: &str, cure: &str| ImportError::Refused {
            source_name: source_name.clone(),
            found: found.to_owned(),
            cure: cure.to_owned(),
        };
        return match read_msh(path) {
            Err(MeshError::Version { .. }) if reader::is_surface(path) => Err(refused(SURFACE, SURFACE_CURE)),
            Err(MeshError::Version { .. }) if format::ending(path) != "msh" => Err(refused(UNKNOWN, UNKNOWN_CURE)),
            read => Ok(Imported { mesh: read?, notes: Vec::new() }),
        };
    }
    let io = |cause| ImportError::Io { source_name: source_name.clone(), cause };
    // Each pass of gmsh has a private folder of its own.
    let by_gmsh = |task| -> Result<Mesh, ImportError> {
        let folder = TemporaryFolder::new().map_err(io)?;
        let target = folder.path().join(TARGET);
        run::gmsh(path, &target, settings, task)?;
        parsed(&target, &source_name)
    };
    let (mesh, notes) = match reader {
        Reader::Own => (read_msh(path)?, Vec::new()),
        Reader::GmshMesher => {
            let first = by_gmsh(GmshTask::Mesh);
            (if is_badly_curved(&first) { by_gmsh(GmshTask::MeshAndOptimize)? } else { first? }, Vec::new())
        }
        Reader::GmshConverter => (by_gmsh(GmshTask::Convert)?, Vec::new()),
        Reader::Meshio => {
            let folder = TemporaryFolder::new().map_err(io)?;
            let target = folder.path().join(TARGET);
            let notes = run::meshio(path, &target, settings)?;
            (parsed(&target, &source_name)?, notes)
        }
    };
    Ok(Imported { mesh, notes })
}

/// The mesh that a program has written, in its private folder.
const TARGET: &str = "mesh.msh";

fn parsed(target: &Path, source_name: &str) -> Result<Mesh, ImportError> {
    let io = |cause| ImportError::Io { source_name: source_name.to_owned(), cause };
    Ok(parse_msh(&std::fs::read(target).map_err(io)?, source_name)?)
}

const SURFACE: &str = "a surface of triangles, which encloses a volume but has no elements in it";
const SURFACE_CURE: &str = "give the part as STEP, which gmsh meshes, or fill the surface with tetrahedra in gmsh: Merge \"SURFACE.stl\"; \
                            Surface Loop(1) = {1}; Volume(1) = {1};";
const UNKNOWN: &str = "no mesh or geometry of a format that is read here";
const UNKNOWN_CURE: &str = "save it as .msh, .inp, .bdf, .med, .vtu, .unv or .step; docs/meshes.md has all formats";

/// A smaller scaled Jacobian is what gmsh's optimisation takes for bad (Mesh.HighOrderThresholdMin).
const BADLY_CURVED: f64 = 0.1;

/// Whether the edges of elements on curved surfaces run through their other faces, or nearly so.
fn is_badly_curved(mesh: &Result<Mesh, ImportError>) -> bool {
    match mesh {
        Ok(mesh) => mesh.least_scaled_jacobian() < BADLY_CURVED,
        Err(error) => matches!(error, ImportError::Mesh(MeshError::Jacobian { .. })),
    }
}

/// Who reads the mesh should know that its file is a program: what to say of it, and of how far it is trusted.
pub fn remark(path: &Path, settings: &ImportSettings) -> Option<String> {
    let trust = match settings.trust_geometry {
        true => "gmsh is free to do all that it says (--trust-geometry)",
        false => "its commands that run others or write files are refused",
    };
    reader::is_program(path).then(|| format!("{} is a program, which gmsh runs: {trust}", path.display()))
}

/// What a mesh follows from: its file, and how it is read. `None` where the file cannot be read or includes others.
pub fn hash_of_mesh(path: &Path, settings: &ImportSettings) -> Option<Hash> {
    // What is no ordinary file can be read only once.
    let file = Some(path).filter(|path| path.is_file()).and_then(|path| Hash::of_file(path).ok())?;
    match reader_of(path, settings) {
        Reader::Own => Some(file),
        _ if reader::includes_others(path) => None,
        reader => {
            // Whoever wrote it is trusted or not, the mesh is the same.
            let settings = ImportSettings { trust_geometry: false, ..*settings };
            Some(Digest::new().hash(&file).text(&format!("{reader:?} {settings:?}")).finish())
        }
    }
}
