//! The kind of a file that a command was given, and the commands that take it.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use diagnostic::{Diagnosis, Diagnostic, Kind};
use mesh_import::{ImportSettings, Reader, reader_of};

/// Bytes of a text in which it is looked for what it is: as many as a scene may have.
const LONGEST_SCENE: u64 = 1 << 20;

/// Kind of a file, as far as commands take it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GivenFile {
    /// A scene.
    Scene,
    /// The file of a sweep.
    Sweep,
    /// A results file, finished or not.
    Results,
    /// A body file, or the table of a sweep.
    Body,
    /// A mesh, or geometry to be meshed.
    Mesh,
    /// A table of numbers.
    Table,
    /// An FMU.
    Fmu,
}

/// A file of another kind than the command takes.
#[derive(Debug, thiserror::Error)]
#[error("{}: found {}, expected {expected}\n = {}", path.display(), found.in_words(), found.taken_by(path))]
pub struct OtherFile {
    /// The file.
    pub path: PathBuf,
    /// Its kind.
    pub found: GivenFile,
    /// The kind that the command takes.
    pub expected: &'static str,
}

impl GivenFile {
    /// The kind of a file; `None` where it cannot be read, or does not say what it is.
    pub fn of(path: &Path) -> Option<Self> {
        // What is no ordinary file can be read only once.
        let file = Some(path).filter(|path| path.is_file()).and_then(|path| File::open(path).ok())?;
        let mut head = Vec::new();
        (&file).take(LONGEST_SCENE).read_to_end(&mut head).ok()?;
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        if head.starts_with(b"flexframe results") {
            return Some(Self::Results);
        }
        if head.starts_with(b"flexframe body") {
            return Some(Self::Body);
        }
        if ending == "msh" || head.starts_with(b"$MeshFormat") || head.starts_with(b"$NOD") {
            return Some(Self::Mesh);
        }
        if reader_of(path, &ImportSettings::default()) != Reader::Own || is_surface(&ending) {
            return Some(Self::Mesh);
        }
        match ending.as_str() {
            "csv" => Some(Self::Table),
            "fmu" => Some(Self::Fmu),
            _ => {
                let table: toml::Table = toml::from_str(std::str::from_utf8(&head).ok()?).ok()?;
                match table.get("scene") {
                    Some(_) if table.contains_key("parameters") || table.contains_key("results") => Some(Self::Sweep),
                    _ => (table.contains_key("body") || table.contains_key("time")).then_some(Self::Scene),
                }
            }
        }
    }

    /// Its name in words.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Scene => "a scene",
            Self::Sweep => "the file of a sweep",
            Self::Results => "a results file of flexframe",
            Self::Body => "a body file of flexframe, or the table of a sweep",
            Self::Mesh => "a mesh or geometry",
            Self::Table => "a table of numbers",
            Self::Fmu => "an FMU",
        }
    }

    /// The commands that take it.
    pub fn taken_by(self, path: &Path) -> String {
        let path = path.display();
        match self {
            Self::Scene => format!(
                "`flexframe run {path}` computes its motion; modes, advise, cost, animate and others take it, too"
            ),
            Self::Sweep => format!("`flexframe sweep {path}` runs it"),
            Self::Results => format!(
                "`flexframe report {path}`, `flexframe export {path} --csv TABLE.csv` and `flexframe animate {path} -o FILE.gif` \
                 show what is in it"
            ),
            Self::Body => {
                "a scene takes a body file: `file = \"…\"` in [body] in place of a mesh; `flexframe fmu` packs it"
                    .to_owned()
            }
            Self::Mesh => format!("`flexframe new {path}` writes a scene of it, which the other commands take"),
            Self::Table => format!(
                "a history of a load takes it: `history = {{ kind = \"table\", file = \"…\" }}`; `flexframe srs {path}` finds its shock \
                 response spectrum"
            ),
            Self::Fmu => {
                "a program that simulates FMUs takes it; flexframe takes the scene that it was made of".to_owned()
            }
        }
    }

    /// Refuses a file that is known to be of another kind than these.
    ///
    /// # Errors
    /// [`OtherFile`].
    pub fn expect(path: &Path, kinds: &[Self], expected: &'static str) -> Result<(), OtherFile> {
        match Self::of(path) {
            Some(found) if !kinds.contains(&found) => Err(OtherFile { path: path.to_owned(), found, expected }),
            _ => Ok(()),
        }
    }
}

/// Surfaces of triangles: `flexframe new` says what they lack.
fn is_surface(ending: &str) -> bool {
    ["stl", "obj", "ply", "off"].contains(&ending)
}

impl Diagnostic for OtherFile {
    fn diagnosis(&self) -> Diagnosis {
        let wrong = Kind::Input.of(&self.path).found(self.found.in_words()).expected(self.expected);
        wrong.help(self.found.taken_by(&self.path))
    }
}
