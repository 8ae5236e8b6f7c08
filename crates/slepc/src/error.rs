//! Errors of SLEPc.

use std::io;
use std::path::{Path, PathBuf};

use diagnostic::{Failure, Kind};

/// The error of a program that is needed and not there, or cannot be used.
pub(crate) fn not_installed(found: &str, help: impl Into<String>) -> Failure {
    Kind::Io.alone().found(found).help(help).says(format!("--solver slepc: {found}"))
}

/// The refusal of the driver, in words.
pub(crate) fn refused(found: &str, help: impl Into<String>) -> Failure {
    Kind::Run.alone().found(found).help(help).says(format!("--solver slepc: {found}"))
}

/// The end of processes that a signal has stopped.
pub(crate) fn stopped(command: &str) -> Failure {
    Kind::Stopped.alone().says(format!("stopped; the processes of `{command}` are ended, and their files removed"))
}

/// The error of a file that cannot be read or written.
pub(crate) fn failed(path: impl Into<PathBuf>, action: &'static str) -> impl FnOnce(io::Error) -> Failure {
    let path = path.into();
    move |error| {
        let help = "check its name, its folder and the room on its disk";
        Kind::Io.of(path).help(help).says(format!("cannot {action}: {error}"))
    }
}

/// The refusal of answers to another problem.
pub(crate) fn other_matrices(folder: &Path) -> Failure {
    let help =
        "name the folder that was written for this scene by this version of flexframe, or write it again: --write-only";
    Kind::Input.of(folder).help(help).says("the answers are those of other matrices than the scene's now")
}

/// The error of a file that is not what the driver writes.
pub(crate) fn damaged(path: &Path, words: impl Into<String>) -> Failure {
    Kind::Input.of(path).help("let the driver write it again").says(words)
}
