//! Errors of SLEPc.

use std::io;
use std::path::PathBuf;

/// Errors of SLEPc.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SlepcError {
    /// A program that is needed is not there, or cannot be used.
    #[error("--solver slepc: {found}\n = {help}")]
    NotInstalled {
        /// The missing part.
        found: String,
        /// Help for the user.
        help: String,
    },
    /// The driver refuses, in words.
    #[error("--solver slepc: {found}\n = {help}")]
    Refused {
        /// The reason.
        found: String,
        /// Help for the user.
        help: String,
    },
    /// The driver did not come to its end.
    #[error("--solver slepc: `{command}` failed ({status}); it said last:\n{said}\n = {help}")]
    Failed {
        /// The command.
        command: String,
        /// Exit status or signal.
        status: String,
        /// The last lines that it said.
        said: String,
        /// Help for the user.
        help: String,
    },
    /// A signal has stopped it.
    #[error("stopped; the processes of `{command}` are ended, and their files removed")]
    Stopped {
        /// The command.
        command: String,
    },
    /// A file cannot be read or written.
    #[error("{}: cannot {action}: {source}\n = check its name, its folder and the room on its disk", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The operation that failed.
        action: &'static str,
        /// The reason.
        source: io::Error,
    },
    /// The driver has not left its answers yet.
    #[error(
        "{}: {name} is not there{what}: the driver has not come to its end{}\n = `sbatch job.sh` in that folder, or `bash job.sh`, and then \
         this command again; what the driver says is in driver.log",
        folder.display(),
        said.as_ref().map_or_else(String::new, |said| format!("; driver.log ends with: {said}"))
    )]
    NotFinished {
        /// The folder.
        folder: PathBuf,
        /// The file that the driver leaves last.
        name: String,
        /// Its content, if that is not plain.
        what: &'static str,
        /// The last line that it said.
        said: Option<String>,
    },
    /// The folder is that of another problem.
    #[error(
        "{}: the answers are those of other matrices than the scene's now\n = name the folder that was written for this scene by this \
         version of flexframe, or write it again: --write-only",
        folder.display()
    )]
    OtherMatrices {
        /// The folder.
        folder: PathBuf,
    },
    /// Fewer modes than are asked for.
    #[error("{}: {found} modes, where {requested} are asked for\n = ask for fewer, or write the folder again: --write-only", folder.display())]
    FewModes {
        /// The folder.
        folder: PathBuf,
        /// How many there are.
        found: usize,
        /// How many are asked for.
        requested: usize,
    },
    /// A file is not what the driver writes.
    #[error("{}: {what}\n = let the driver write it again", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// The fault.
        what: String,
    },
}

impl SlepcError {
    pub(crate) fn io(path: impl Into<PathBuf>, action: &'static str) -> impl FnOnce(io::Error) -> Self {
        let path = path.into();
        move |source| Self::Io { path, action, source }
    }
}
