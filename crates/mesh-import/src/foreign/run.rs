//! The programs that read other formats.

use std::borrow::Cow;
use std::collections::VecDeque;
use std::ffi::OsStr;
use std::path::Path;
use std::process::ExitStatus;
use std::time::Duration;

use foreign_program::{ForeignProgram, Limits, ProgramError, Stream, named};
use memory::Left;
use serde::Deserialize;
use whole_file::TemporaryFolder;

use crate::contents::Copies;
use crate::error::ImportError;
use crate::foreign::gmsh_errors::{error_in, without_words};
use crate::settings::ImportSettings;

/// The program that meshio runs.
const WITH_MESHIO: &str = include_str!("with_meshio.py");
/// Its part for Exodus, by the name under which it takes it in.
const EXODUS: (&str, &str) = ("exodus.py", include_str!("exodus.py"));
/// Names Python, where it is not `python3`.
const PYTHON: &str = "FLEXFRAME_PYTHON";
/// Names gmsh, where it is not `gmsh`.
const GMSH: &str = "FLEXFRAME_GMSH";

/// A mesh that takes longer, or is larger, is none for which anybody waits here.
const LIMITS: Limits = Limits { time: Some(Duration::from_secs(12 * 3600)), bytes: Some(64 << 30), memory: None };
const TOO_MUCH: &str = "mesh it yourself with gmsh -3 -order 2 -format msh41, and name that mesh";
/// Lines that are kept of what a program says.
const KEPT: usize = 100;

const GMSH_CURE: &str = "install gmsh (Debian: apt install gmsh; or pip install gmsh), or name it in FLEXFRAME_GMSH";
const PYTHON_CURE: &str = "install Python 3 with meshio (pip install meshio h5py), name that Python in FLEXFRAME_PYTHON, or \
                           write the mesh as MSH 4.1";

/// The answer of the program in one line of JSON.
#[derive(Deserialize)]
#[serde(untagged)]
enum Answer {
    Done { notes: Vec<String> },
    Refused { error: String, help: String },
}

/// A mesh file that another program is to read.
pub(crate) struct Job<'a> {
    /// Its name in messages.
    pub(crate) source: &'a Path,
    pub(crate) settings: &'a ImportSettings,
    /// The copies that the program is given.
    pub(crate) copies: &'a Copies,
    /// The MSH 4.1 file that it is to write, in a private folder.
    pub(crate) target: &'a Path,
    /// True if the file is a program that may do what it likes.
    pub(crate) is_free: bool,
}

/// Lets meshio do a job. Returns what was left out.
pub(crate) fn meshio(job: &Job<'_>) -> Result<Vec<String>, ImportError> {
    let &Job { source, settings, copies, target, .. } = job;
    let folder = folder_of(target);
    let python = named(PYTHON, "python3");
    let program = folder.join("with_meshio.py");
    std::fs::write(&program, WITH_MESHIO).map_err(of(source))?;
    std::fs::write(folder.join(EXODUS.0), EXODUS.1).map_err(of(source))?;
    let mut command = ForeignProgram::new(&python, folder).arg(&program).arg(copies.first()).arg(target);
    if settings.raise_order {
        command = command.arg("raise");
    }
    let said = Said::by(command, source, &python, ("meshio", PYTHON_CURE))?;
    match said.last(Stream::Output).and_then(|line| serde_json::from_str(line).ok()) {
        Some(Answer::Done { notes }) if said.status.success() => Ok(notes),
        Some(Answer::Refused { error, help }) => {
            let source_name = source.display().to_string();
            Err(ImportError::Refused { source_name, found: copies.translated(&error), help })
        }
        _ => Err(said.failed(source, &python, (copies, false), "check the file, or write the mesh as MSH 4.1")),
    }
}

/// Work of gmsh on the way from a file to MSH 4.1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum GmshTask {
    /// Nothing: the file is a mesh.
    Convert,
    /// It meshes geometry.
    Mesh,
    /// After that it moves nodes until no element is inverted by its curved edges; several times the work.
    MeshAndOptimize {
        /// Scaled Jacobian determinant above which it leaves an element as it is.
        threshold: f64,
    },
}

/// Lets gmsh do a job.
pub(crate) fn gmsh(job: &Job<'_>, task: GmshTask) -> Result<(), ImportError> {
    let &Job { source, settings, copies, target, is_free } = job;
    let folder = folder_of(target);
    let gmsh = named(GMSH, "gmsh");
    // The user's options of gmsh are for a mesh that he looks at; they are not read here.
    let mut command = match task {
        GmshTask::MeshAndOptimize { .. } if has_fixed_addresses() => with_fixed_addresses(folder).arg(&gmsh),
        _ => ForeignProgram::new(&gmsh, folder),
    };
    command = command.env("GMSH_HOME", folder);
    command = if is_free { command.in_folder(folder_of(copies.first())) } else { command.env("HOME", folder) };
    if task != GmshTask::Convert {
        command = command.arg(copies.first());
        if let Some(size) = settings.mesh_size {
            // After the geometry, which may set a size of its own; the option -clmax comes before it.
            let file = folder.join("size.geo");
            std::fs::write(&file, format!("Mesh.MeshSizeMax = {size:e};\n")).map_err(of(source))?;
            command = command.arg(file);
        }
        command = command.args(["-3", "-order", "2"]);
        if let GmshTask::MeshAndOptimize { threshold } = task {
            let file = folder.join("threshold.geo");
            std::fs::write(&file, format!("Mesh.HighOrderThresholdMin = {threshold:e};\n")).map_err(of(source))?;
            command = command.arg(file).arg("-optimize_ho");
        }
    } else if settings.raise_order {
        // The option -order only acts on what is meshed.
        let script = folder.join("raise.geo");
        let name = copies.first().file_name().unwrap_or_default().display();
        let text = format!("Merge \"{name}\";\nSetOrder 2;\n");
        std::fs::write(&script, text).map_err(of(source))?;
        command = command.arg(script).arg("-save");
    } else {
        command = command.arg(copies.first()).arg("-save");
    }
    command = command.args(["-v", "2", "-format", "msh41", "-o"]).arg(target);
    let said = Said::by(command, source, &gmsh, ("gmsh", GMSH_CURE))?;
    // Some versions end with success after an error.
    if !said.status.success() || !target.is_file() || said.first_errors.iter().any(Option::is_some) {
        let help = match task {
            GmshTask::Convert => "open it in gmsh, and see what is wrong with it",
            GmshTask::Mesh | GmshTask::MeshAndOptimize { .. } => {
                "try a smaller mesh_size, or open it in gmsh, and see what is wrong with it"
            }
        };
        return Err(said.failed(source, &gmsh, (copies, settings.hides_lines), help));
    }
    Ok(())
}

/// Runs the program that is named after it without a random layout of its addresses. gmsh's optimization takes elements in the
/// order of their addresses: else it would give another mesh each time, and a run could not be resumed.
fn with_fixed_addresses(folder: &Path) -> ForeignProgram {
    ForeignProgram::new("setarch".as_ref(), folder).arg("-R")
}

/// True if the system has that, and allows it.
fn has_fixed_addresses() -> bool {
    // Where it cannot be started, its private folder is removed.
    let Ok(folder) = TemporaryFolder::new() else { return false };
    let nothing = with_fixed_addresses(folder.path()).arg("true");
    nothing.run(LIMITS, || false, |_, _| ()).is_ok_and(|status| status.success())
}

/// The output of a program, and how it has ended.
struct Said {
    status: ExitStatus,
    /// The first error of gmsh on standard output, where Open CASCADE says more of it, and on standard error.
    first_errors: [Option<String>; 2],
    /// The last lines that are not empty.
    lines: VecDeque<(Stream, String)>,
}

impl Said {
    fn by(
        command: ForeignProgram,
        source: &Path,
        program: &OsStr,
        (reader, help): (&'static str, &'static str),
    ) -> Result<Self, ImportError> {
        let mut lines = VecDeque::new();
        let mut first_errors = [None, None];
        let hear = |stream, line: String| {
            if line.trim().is_empty() {
                return;
            }
            let first = &mut first_errors[usize::from(stream == Stream::Error)];
            *first = first.take().or_else(|| error_in(&line));
            if lines.len() == KEPT {
                lines.pop_front();
            }
            lines.push_back((stream, line.trim().to_owned()));
        };
        let [source_name, program] = [source.as_os_str(), program].map(|name| name.to_string_lossy().into_owned());
        // One that wants more than there is ends itself, and not others.
        let memory = Left::of_machine().and_then(|left| left.bytes()).map(|bytes| bytes as u64);
        match command.run(Limits { memory, ..LIMITS }, || false, hear) {
            Ok(status) => Ok(Self { status, first_errors, lines }),
            Err(ProgramError::Start(cause)) => Err(ImportError::NoReader { source_name, reader, program, cause, help }),
            Err(cause) => Err(ImportError::TooMuch { source_name, program, cause, help: TOO_MUCH }),
        }
    }

    /// The last line of a stream.
    fn last(&self, stream: Stream) -> Option<&str> {
        self.lines.iter().rev().find(|(of, _)| *of == stream).map(|(_, line)| line.as_str())
    }

    fn failed(
        &self,
        source: &Path,
        program: &OsStr,
        (copies, hides_lines): (&Copies, bool),
        help: &'static str,
    ) -> ImportError {
        let last = || self.last(Stream::Error).or_else(|| self.last(Stream::Output));
        let said =
            self.first_errors.iter().flatten().next().map(String::as_str).or_else(last).unwrap_or("it says nothing");
        let said = if hides_lines { without_words(said) } else { Cow::Borrowed(said) };
        ImportError::Failed {
            source_name: source.display().to_string(),
            program: program.to_string_lossy().into_owned(),
            status: self.status.to_string(),
            said: copies.translated(&said),
            help,
        }
    }
}

fn of(source: &Path) -> impl Fn(std::io::Error) -> ImportError + use<> {
    let source_name = source.display().to_string();
    move |cause| ImportError::Io { source_name: source_name.clone(), cause }
}

fn folder_of(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new(""))
}
