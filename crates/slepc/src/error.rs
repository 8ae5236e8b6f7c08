//! Errors of SLEPc.

use std::io;
use std::path::PathBuf;

use diagnostic::{Diagnosis, Diagnostic, Kind};

/// Errors of SLEPc.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum SlepcError {
    /// A program that is needed is not there, or cannot be used.
    #[error("--solver slepc: {found}\n = {help}")]
    NotInstalled { found: String, help: String },
    /// The driver refuses, in words.
    #[error("--solver slepc: {found}\n = {help}")]
    Refused { found: String, help: String },
    /// The driver did not come to its end. `said`: the last lines.
    #[error("--solver slepc: `{command}` failed ({status}); it said last:\n{said}\n = {help}")]
    Failed { command: String, status: String, said: String, help: String },
    /// A signal has stopped it.
    #[error("stopped; the processes of `{command}` are ended, and their files removed")]
    Stopped { command: String },
    /// A file cannot be read or written.
    #[error("{}: cannot {action}: {source}\n = check its name, its folder and the room on its disk", path.display())]
    Io { path: PathBuf, action: &'static str, source: io::Error },
    /// The driver has not left its answers yet. `name`: the file that the driver leaves last; `what`: its content, if
    /// that is not plain; `said`: the last line that it said.
    #[error(
        "{}: {name} is not there{what}: the driver has not come to its end{}\n = `sbatch job.sh` in that folder, or `bash job.sh`, and then \
         this command again; what the driver says is in driver.log",
        folder.display(),
        said.as_ref().map_or_else(String::new, |said| format!("; driver.log ends with: {said}"))
    )]
    NotFinished { folder: PathBuf, name: String, what: &'static str, said: Option<String> },
    /// The folder is that of another problem.
    #[error(
        "{}: the answers are those of other matrices than the scene's now\n = name the folder that was written for this scene by this \
         version of flexframe, or write it again: --write-only",
        folder.display()
    )]
    OtherMatrices { folder: PathBuf },
    /// Fewer modes than are asked for.
    #[error("{}: {found} modes, where {requested} are asked for\n = ask for fewer, or write the folder again: --write-only", folder.display())]
    FewModes { folder: PathBuf, found: usize, requested: usize },
    /// A file is not what the driver writes.
    #[error("{}: {what}\n = let the driver write it again", path.display())]
    Damaged { path: PathBuf, what: String },
}

impl SlepcError {
    pub(crate) fn io(path: impl Into<PathBuf>, action: &'static str) -> impl FnOnce(io::Error) -> Self {
        let path = path.into();
        move |source| Self::Io { path, action, source }
    }
}

impl Diagnostic for SlepcError {
    fn diagnosis(&self) -> Diagnosis {
        match self {
            Self::NotInstalled { found, help } => Kind::Io.alone().found(found).help(help),
            Self::Refused { found, help } => Kind::Run.alone().found(found).help(help),
            Self::Failed { status, help, .. } => Kind::Run.alone().found(status).help(help),
            Self::Stopped { .. } => Kind::Stopped.alone(),
            Self::Io { path, .. } | Self::NotFinished { folder: path, .. } => Kind::Io.of(path),
            Self::Damaged { path, .. } | Self::OtherMatrices { folder: path } | Self::FewModes { folder: path, .. } => {
                Kind::Input.of(path)
            }
        }
    }
}
