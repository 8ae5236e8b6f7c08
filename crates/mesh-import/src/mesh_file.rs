//! A mesh file that is read once.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use fem_tet10::{Mesh, MeshError, MeshFault, msh_bytes, parse_msh};
use keys::{Hash, Key};
use whole_file::TemporaryFolder;

use crate::beside::Beside;
use crate::contents::{Copies, ReadFile, contents, opened};
use crate::error::ImportError;
use crate::foreign::geometry::geometry;
use crate::foreign::run::{self, GmshTask, Job};
use crate::format::ending;
use crate::imported::Imported;
use crate::own::abaqus;
use crate::own::deck::deck;
use crate::own::nastran;
use crate::own::universal;
use crate::reader::{Reader, is_program, is_surface, names_others, reader_of};
use crate::settings::ImportSettings;

/// A mesh file with all that it includes, as they were when they were read. Its hash and its mesh follow from the same bytes,
/// whatever becomes of the files.
#[derive(Debug)]
pub struct MeshFile {
    path: PathBuf,
    settings: ImportSettings,
    reader: Reader,
    held: Held,
}

/// The files for another program, or the bytes that flexframe reads itself.
#[derive(Debug)]
enum Held {
    /// Contents, the first file first.
    Files(Vec<ReadFile>),
    /// A file that is read where it is, with others that cannot be told before.
    InPlace,
}

impl MeshFile {
    /// Reads the file and what it includes. No other program is run.
    ///
    /// # Errors
    /// [`ImportError`]: a file cannot be read, or is not what its name says.
    pub fn read(path: &Path, settings: &ImportSettings) -> Result<Self, ImportError> {
        let reader = reader_of(path, settings);
        let one = |bytes, name| {
            let includes = BTreeMap::new();
            Held::Files(vec![ReadFile { path: path.to_owned(), name, bytes: Some(bytes), includes, is_hidden: false }])
        };
        let mut held = match reader {
            Reader::Own => one(msh_bytes(path)?, String::new()),
            Reader::GmshMesher if is_program(path) => match geometry(path) {
                Err(ImportError::Refused { .. }) if settings.trust_geometry => Held::InPlace,
                read => Held::Files(read?),
            },
            // Universal files include no others.
            Reader::OwnDeck if ending(path) != "unv" => Held::Files(deck(path)?),
            _ => match contents(path)? {
                bytes if names_others(path, &bytes) => Held::InPlace,
                bytes => one(bytes, format!("source.{}", ending(path))),
            },
        };
        if let Held::Files(files) = &mut held {
            files.iter_mut().for_each(|file| file.is_hidden |= settings.hides_lines);
        }
        Ok(Self { path: path.to_owned(), settings: *settings, reader, held })
    }

    /// Hash of all that the mesh follows from: all bytes that were read, and how. `None` where another program reads what it
    /// likes.
    pub fn hash(&self) -> Option<Hash> {
        let Held::Files(files) = &self.held else { return None };
        if let (Reader::Own, [ReadFile { bytes: Some(bytes), .. }]) = (self.reader, &files[..]) {
            return Some(Hash::of(bytes));
        }
        // Whoever wrote it is trusted or not, the mesh is the same.
        let ImportSettings { mesh_size, raise_order, trust_geometry: _, hides_lines: _ } = &self.settings;
        let start = Key::new().of("mesh", 2).with("reader", self.reader.name());
        let start = start.with("mesh size", mesh_size).with("raise order", raise_order);
        let with = |key: Key, file: &ReadFile| match &file.bytes {
            Some(bytes) => key.with("name", file.name.as_str()).with("bytes", &Hash::of(bytes)),
            None => key,
        };
        Some(files.iter().fold(start, with).finish())
    }

    /// Who reads the mesh should know that its file is a program: what to say of it, and of how far it is trusted.
    pub fn remark(&self) -> Option<String> {
        let trust = match self.settings.trust_geometry {
            true => "gmsh is free to do all that it says (--trust-geometry)",
            false => "its commands that run others or write files are refused",
        };
        is_program(&self.path).then(|| format!("{} is a program, which gmsh runs: {trust}", self.path.display()))
    }

    /// Makes the mesh, through another program where that is needed.
    ///
    /// # Errors
    /// [`ImportError`]: no program is there to read it, or it is not a mesh of second-order tetrahedra.
    pub fn mesh(&self) -> Result<Imported, ImportError> {
        let mesh = match self.reader {
            Reader::Own => self.own()?,
            Reader::GmshMesher => match self.by_gmsh(GmshTask::Mesh) {
                first if is_badly_curved(&first) => self.optimized()?,
                first => first?,
            },
            Reader::GmshConverter => self.by_gmsh(GmshTask::Convert)?,
            Reader::OwnDeck => {
                let Held::Files(files) = &self.held else {
                    return Ok(Imported {
                        mesh: self.own()?,
                        notes: Vec::new(),
                        materials: Vec::new(),
                        beside: Beside::default(),
                    });
                };
                let read = match &*ending(&self.path) {
                    "inp" => abaqus::read,
                    "unv" => universal::read,
                    _ => nastran::read,
                };
                return read(files, &self.path, self.settings.raise_order);
            }
            Reader::Meshio => {
                let (mesh, notes) = self.by_another(run::meshio)?;
                return Ok(Imported { mesh, notes, materials: Vec::new(), beside: Beside::default() });
            }
        };
        Ok(Imported { mesh, notes: Vec::new(), materials: Vec::new(), beside: Beside::default() })
    }

    fn own(&self) -> Result<Mesh, ImportError> {
        let path = &self.path;
        let refused = |found: &str, help: &str| ImportError::Refused {
            source_name: path.display().to_string(),
            found: found.to_owned(),
            help: help.to_owned(),
        };
        let bytes = match &self.held {
            Held::Files(files) => files.first().and_then(|file| file.bytes.as_deref()),
            Held::InPlace => None,
        };
        match parse_msh(bytes.unwrap_or_default(), &path.display().to_string()) {
            Err(MeshError { fault: MeshFault::Version { .. }, .. }) if is_surface(path) => {
                Err(refused(SURFACE, SURFACE_CURE))
            }
            Err(MeshError { fault: MeshFault::Version { .. }, .. }) if ending(path) != "msh" => {
                Err(refused(UNKNOWN, cure(&self.path)))
            }
            read => Ok(read?),
        }
    }

    /// Mesh of gmsh's optimization that is not badly curved, or the best of several.
    ///
    /// gmsh judges an element by another measure, and leaves a few below its threshold now and then, depending on the
    /// machine. A higher threshold is another path through its optimization.
    fn optimized(&self) -> Result<Mesh, ImportError> {
        let mut best = self.by_gmsh(GmshTask::MeshAndOptimize { threshold: THRESHOLDS[0] });
        for threshold in &THRESHOLDS[1..] {
            if !is_badly_curved(&best) {
                break;
            }
            let next = self.by_gmsh(GmshTask::MeshAndOptimize { threshold: *threshold });
            let least = |mesh: &Result<Mesh, ImportError>| mesh.as_ref().map_or(f64::MIN, Mesh::least_scaled_jacobian);
            if least(&next) > least(&best) {
                best = next;
            }
        }
        best
    }

    fn by_gmsh(&self, task: GmshTask) -> Result<Mesh, ImportError> {
        self.by_another(|job| run::gmsh(job, task)).map(|(mesh, ())| mesh)
    }

    /// Has another program write the mesh, in a private folder of its own.
    fn by_another<T>(&self, run: impl FnOnce(&Job<'_>) -> Result<T, ImportError>) -> Result<(Mesh, T), ImportError> {
        let source_name = self.path.display().to_string();
        let io = |cause| ImportError::Io { source_name: source_name.clone(), cause };
        let folder = TemporaryFolder::new().map_err(io)?;
        let (copies, is_free) = match &self.held {
            Held::Files(files) => {
                let in_folder = |cause: std::io::Error| {
                    std::io::Error::new(cause.kind(), format!("{}: {cause}", folder.path().display()))
                };
                (Copies::of(files, folder.path()).map_err(in_folder).map_err(io)?, false)
            }
            Held::InPlace => {
                opened(&self.path)?;
                let place = std::path::absolute(&self.path).map_err(io)?;
                (Copies(vec![(self.path.clone(), place)]), is_program(&self.path))
            }
        };
        let target = folder.path().join(TARGET);
        let (source, settings) = (&*self.path, &self.settings);
        let said = run(&Job { source, settings, copies: &copies, target: &target, is_free })?;
        let mesh = parse_msh(&std::fs::read(target).map_err(io)?, &source_name)?;
        Ok((mesh, said))
    }
}

/// The mesh that a program has written, in its private folder.
const TARGET: &str = "mesh.msh";

const SURFACE: &str = "a surface of triangles, which encloses a volume but has no elements in it";
const SURFACE_CURE: &str = "give the part as STEP, which gmsh meshes, or fill the surface with tetrahedra in gmsh: Merge \"SURFACE.stl\"; \
                            Surface Loop(1) = {1}; Volume(1) = {1};";
const UNKNOWN: &str = "no mesh or geometry of a format that is read here";
const UNKNOWN_CURE: &str =
    "save it as .msh, .inp, .bdf, .med, .vtu, .unv or .step; docs/reference/meshes.md has all formats";

/// Endings of files that are not read, and what to do.
fn cure(path: &Path) -> &'static str {
    match ending(path).as_str() {
        "cdb" => {
            "a deck of Ansys: save it as VTU with mapdl-archive in Python (docs/reference/meshes.md says how), or as .bdf, .inp or .unv in the \
             program that wrote it"
        }
        "dat" => {
            "name a deck of Nastran .bdf, one of Abaqus or CalculiX .inp; docs/reference/meshes.md has all formats"
        }
        _ => UNKNOWN_CURE,
    }
}

/// A smaller scaled Jacobian is what gmsh's optimisation takes for bad (Mesh.HighOrderThresholdMin).
const BADLY_CURVED: f64 = 0.1;
/// Thresholds of gmsh's optimization, one after the other: its own, and two that ask for more.
const THRESHOLDS: [f64; 3] = [0.1, 0.2, 0.3];

/// True if the edges of elements on curved surfaces run through their other faces, or nearly so.
fn is_badly_curved(mesh: &Result<Mesh, ImportError>) -> bool {
    match mesh {
        Ok(mesh) => mesh.least_scaled_jacobian() < BADLY_CURVED,
        Err(error) => matches!(error, ImportError::Mesh(MeshError { fault: MeshFault::Jacobian { .. }, .. })),
    }
}
