//! A file that cannot be written.

use std::io;
use std::path::{Path, PathBuf};

use diagnostic::{Diagnosis, Diagnostic, Kind};

/// A file or folder that the system does not let be written.
#[derive(Debug, thiserror::Error)]
#[error("{}: cannot be written: {source}\n = {}", path.display(), help_of_writing(source))]
pub struct WriteError {
    /// The file.
    pub path: PathBuf,
    /// The reason.
    pub source: io::Error,
}

impl WriteError {
    /// Makes an error of the system that of a file.
    pub fn of(path: &Path) -> impl FnOnce(io::Error) -> Self {
        move |source| Self { path: path.to_owned(), source }
    }
}

/// Help where the system does not let a file or a folder be written.
pub(crate) fn help_of_writing(source: &io::Error) -> &'static str {
    match source.kind() {
        io::ErrorKind::NotFound => "make the folder that it is to be in, or correct its path",
        io::ErrorKind::AlreadyExists | io::ErrorKind::NotADirectory => {
            "a file stands where a folder is to be: name another folder, or move the file away"
        }
        io::ErrorKind::IsADirectory => "a folder of this name is there: name a file",
        io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
            "name a place where you may write, or change its permissions"
        }
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
            "make room on its disk, or name a place on another"
        }
        _ => "check its folder and the room on its disk, or name another place",
    }
}

impl Diagnostic for WriteError {
    fn diagnosis(&self) -> Diagnosis {
        Kind::Io.of(&self.path)
    }
}
