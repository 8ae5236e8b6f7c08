//! Who reads a file.

use std::path::Path;

use crate::contents::opened;
use crate::format::ending;
use crate::settings::ImportSettings;

/// Who reads a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reader {
    /// flexframe itself: MSH 4.1, and what has no known ending.
    Own,
    /// flexframe itself: decks of Abaqus, CalculiX and Nastran, universal files.
    OwnDeck,
    /// gmsh, which meshes geometry.
    GmshMesher,
    /// gmsh, which writes other meshes as MSH 4.1.
    GmshConverter,
    /// meshio, in Python.
    Meshio,
}

impl Reader {
    /// Its name in keys.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Own => "own",
            Self::OwnDeck => "own, decks",
            Self::GmshMesher => "gmsh, meshing",
            Self::GmshConverter => "gmsh, converting",
            Self::Meshio => "meshio",
        }
    }
}

/// Geometry.
const MESHED: [&str; 7] = ["geo", "geo_unrolled", "step", "stp", "iges", "igs", "brep"];
/// Meshes that meshio reads, and Exodus, which the program around it reads.
const THROUGH_MESHIO: [&str; 13] =
    ["med", "vtu", "vtk", "xdmf", "xmf", "mesh", "meshb", "e", "exo", "ex2", "g", "gen", "h5m"];
/// Decks and universal files.
const DECKS: [&str; 5] = ["inp", "bdf", "nas", "fem", "unv"];

/// Who reads a file, by the ending of its name; of `.msh`, by its version, too.
pub fn reader_of(path: &Path, settings: &ImportSettings) -> Reader {
    let ending = ending(path);
    let is_of = |endings: &[&str]| endings.contains(&ending.as_str());
    if is_of(&DECKS) {
        Reader::OwnDeck
    } else if is_of(&MESHED) {
        Reader::GmshMesher
    } else if ending == "msh" && (settings.raise_order || is_older_msh(path)) {
        Reader::GmshConverter
    } else if is_of(&THROUGH_MESHIO) {
        Reader::Meshio
    } else {
        Reader::Own
    }
}

/// True if a file has the name of a surface of triangles.
pub(crate) fn is_surface(path: &Path) -> bool {
    ["stl", "obj", "ply", "off"].contains(&ending(path).as_str())
}

/// True if a MSH file is of version 1, 2 or 4.0.
fn is_older_msh(path: &Path) -> bool {
    // What does not begin as a MSH file is refused by who reads it.
    let Ok((head, _)) = opened(path) else { return false };
    let head = String::from_utf8_lossy(&head);
    let mut lines = head.lines().map(str::trim).skip_while(|line| *line != "$MeshFormat");
    match lines.nth(1) {
        Some(format) => {
            ["1", "2", "2.0", "2.1", "2.2", "4", "4.0"].iter().any(|old| format.split(' ').next() == Some(old))
        }
        None => head.starts_with("$NOD"),
    }
}

/// True if a file is a program for gmsh.
pub(crate) fn is_program(path: &Path) -> bool {
    ["geo", "geo_unrolled"].contains(&ending(path).as_str())
}

/// True if a file has its data in others beside it.
pub(crate) fn names_others(path: &Path, bytes: &[u8]) -> bool {
    let text = || String::from_utf8_lossy(bytes).to_lowercase();
    ["xdmf", "xmf"].contains(&ending(path).as_str())
        && ["hdf", "binary", "include"].iter().any(|word| text().contains(word))
}
