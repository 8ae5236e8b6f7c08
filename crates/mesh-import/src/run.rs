//! The programs that read other formats.

use std::ffi::OsString;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde::Deserialize;

use crate::error::ImportError;
use crate::reader::ending;
use crate::settings::ImportSettings;

/// The program that meshio runs.
const WITH_MESHIO: &str = include_str!("with_meshio.py");
/// Names Python, where it is not `python3`.
const PYTHON: &str = "FLEXFRAME_PYTHON";
/// Names gmsh, where it is not `gmsh`.
const GMSH: &str = "FLEXFRAME_GMSH";

const GMSH_CURE: &str = "install gmsh (Debian: apt install gmsh; or pip install gmsh), or name it in FLEXFRAME_GMSH";
const PYTHON_CURE: &str = "install Python 3 with meshio (pip install meshio h5py), name that Python in FLEXFRAME_PYTHON, or \
                           write the mesh as MSH 4.1";

/// What the program says in one line of JSON.
#[derive(Deserialize)]
#[serde(untagged)]
enum Said {
    Done { notes: Vec<String> },
    Refused { error: String, cure: String },
}

/// Lets meshio read `source` and write it to `target` as MSH 4.1. Returns what was left out.
pub(crate) fn meshio(source: &Path, target: &Path, settings: &ImportSettings) -> Result<Vec<String>, ImportError> {
    let source_name = source.display().to_string();
    let python = std::env::var_os(PYTHON).unwrap_or_else(|| "python3".into());
    let mut command = Command::new(&python);
    command.arg("-").arg(not_an_option(source)).arg(target);
    if settings.raise_order {
        command.arg("raise");
    }
    let no_reader = |cause| ImportError::NoReader {
        source_name: source_name.clone(),
        reader: "meshio",
        program: python.to_string_lossy().into_owned(),
        cause,
        cure: PYTHON_CURE,
    };
    let output = fed(command, WITH_MESHIO).map_err(no_reader)?;
    match last_line(&output.stdout).and_then(|line| serde_json::from_str(&line).ok()) {
        Some(Said::Done { notes }) if output.status.success() => Ok(notes),
        Some(Said::Refused { error, cure }) => Err(ImportError::Refused { source_name, found: error, cure }),
        _ => Err(failed(source_name, &python, &output, "check the file, or write the mesh as MSH 4.1")),
    }
}

/// Lets gmsh write `source` to `target` as MSH 4.1: geometry, `meshed` on the way, or another mesh.
pub(crate) fn gmsh(
    source: &Path,
    target: &Path,
    settings: &ImportSettings,
    meshed: bool,
) -> Result<Vec<String>, ImportError> {
    let source_name = source.display().to_string();
    let gmsh = std::env::var_os(GMSH).unwrap_or_else(|| "gmsh".into());
    let io = |cause| ImportError::Io { source_name: source_name.clone(), cause };
    let mut command = Command::new(&gmsh);
    if meshed {
        command.arg(not_an_option(source));
        if let Some(size) = settings.mesh_size {
            // After the geometry, which may set a size of its own; the option -clmax comes before it.
            let file = target.with_file_name("size.geo");
            std::fs::write(&file, format!("Mesh.MeshSizeMax = {size:e};\n")).map_err(io)?;
            command.arg(file);
        }
        command.args(["-3", "-order", "2"]);
    } else if settings.raise_order {
        // The option -order only acts on what is meshed.
        let copy = format!("first_order.{}", ending(source));
        std::fs::copy(source, target.with_file_name(&copy)).map_err(io)?;
        let script = target.with_file_name("raise.geo");
        std::fs::write(&script, format!("Merge \"{copy}\";\nSetOrder 2;\n")).map_err(io)?;
        command.arg(script).arg("-save");
    } else {
        command.arg(not_an_option(source)).arg("-save");
    }
    command.args(["-v", "2", "-format", "msh41", "-o"]).arg(target);
    let output = fed(command, "").map_err(|cause| ImportError::NoReader {
        source_name: source_name.clone(),
        reader: "gmsh",
        program: gmsh.to_string_lossy().into_owned(),
        cause,
        cure: GMSH_CURE,
    })?;
    if !output.status.success() || !target.is_file() {
        return Err(failed(source_name, &gmsh, &output, "open it in gmsh and see what is wrong with it"));
    }
    Ok(Vec::new())
}

/// Runs a command with a text on its standard input.
fn fed(mut command: Command, text: &str) -> std::io::Result<Output> {
    let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn()?;
    if let Some(mut input) = child.stdin.take() {
        // A program that does not read it says why.
        let _ = input.write_all(text.as_bytes());
    }
    child.wait_with_output()
}

fn failed(source_name: String, program: &OsString, output: &Output, cure: &'static str) -> ImportError {
    let said = last_line(&output.stderr).or_else(|| last_line(&output.stdout));
    ImportError::Failed {
        source_name,
        program: program.to_string_lossy().into_owned(),
        status: output.status.to_string(),
        said: said.unwrap_or_else(|| "it says nothing".to_owned()),
        cure,
    }
}

fn last_line(bytes: &[u8]) -> Option<String> {
    let text = String::from_utf8_lossy(bytes);
    text.lines().rev().map(str::trim).find(|line| !line.is_empty()).map(str::to_owned)
}

/// A path that no program takes for an option.
fn not_an_option(path: &Path) -> PathBuf {
    if path.is_absolute() { path.to_owned() } else { Path::new(".").join(path) }
}
