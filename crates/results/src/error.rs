//! Errors of a results file.

use diagnostic::{Diagnosis, Diagnostic, Kind};
use sealed::SealedError;
use std::path::{Path, PathBuf};

/// An error of the HDF5 writer or reader.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum FileError {
    /// The file cannot be made, read or written, or is not what a writer wrote.
    #[error("{0}")]
    Sealed(#[from] SealedError),
    /// Another process has the file open for writing.
    #[error(
        "{path}: another run is writing this file, or another program has it open; wait for it, stop it, or choose another folder",
        path = .path.display()
    )]
    Busy { path: PathBuf },
    /// A run of the same name was cut off.
    #[error(
        "{path}: this is an unfinished run; go on with it (`flexframe resume {path}`), or throw it away with --overwrite",
        path = .path.display()
    )]
    Unfinished { path: PathBuf },
    /// Something else is where the results would go.
    #[error(
        "{path}: the file there is not a results file of flexframe; choose another folder, move it away, or replace it with --overwrite (a folder never)",
        path = .path.display()
    )]
    NotResults { path: PathBuf },
    /// The run to be resumed has come to its end.
    #[error("{path}: this run is complete; there is nothing to resume", path = .path.display())]
    Complete { path: PathBuf },
    /// The run has not come to its end.
    #[error("{path}: this run is unfinished, and its file has no trust card yet: let it come to its end, or go on with `flexframe resume`", path = .path.display())]
    NotComplete { path: PathBuf },
    /// There is no unfinished run.
    #[error(
        "{path}: there is no unfinished run ({part} does not exist); check the name, or begin with `flexframe run`",
        path = .path.display(),
        part = .part.display()
    )]
    NothingToResume { path: PathBuf, part: PathBuf },
    /// The name of a body, an output point or a support that cannot be part of a path, or occurs twice. `kind`: "body",
    /// "output point" or "support".
    #[error(
        "{path}: the {kind} \"{name}\" cannot be stored: {reason}; give it another name",
        path = .path.display()
    )]
    PlaceName { path: PathBuf, kind: &'static str, name: String, reason: &'static str },
    /// A text holds a NUL character, at which HDF5 strings end.
    #[error("{path}: the text of `{attribute}` holds a NUL character; remove it", path = .path.display())]
    NulInText { path: PathBuf, attribute: String },
    /// A row or the metadata have a list of the wrong length.
    #[error("{path}: {quantity} has {found} values where {expected} are expected", path = .path.display())]
    WrongLength { path: PathBuf, quantity: String, expected: usize, found: usize },
    /// A NaN or an infinity in a row; the row is not stored, those before it are. `time`: in the run's unit.
    #[error(
        "{path}: {quantity} is {value} at time {time}: the run has become unstable there; \
         use a smaller step (the rows before it are in the file)",
        path = .path.display()
    )]
    NotFinite { path: PathBuf, time: f64, quantity: String, value: f64 },
    /// A constant of the run that is not finite.
    #[error("{path}: {quantity} is {value}, expected a finite number; check the scene's numbers and units", path = .path.display())]
    ConstantNotFinite { path: PathBuf, quantity: String, value: f64 },
    /// A symbolic link is where a results file would go.
    #[error(
        "{path}: this is a symbolic link (to {target}); results are not written through a link, nor in its place: remove \
         it, move it away, or choose another folder",
        path = .path.display(),
        target = .target.display()
    )]
    Link { path: PathBuf, target: PathBuf },
    /// A file is where a results file or an export would go.
    #[error("{path}: this file is there already; choose another name or folder, or replace it with --overwrite", path = .path.display())]
    Exists { path: PathBuf },
}

/// Refuses a list of the wrong length.
pub(crate) fn check_length(path: &Path, quantity: &str, expected: usize, found: usize) -> Result<(), FileError> {
    if expected == found {
        return Ok(());
    }
    Err(FileError::WrongLength { path: path.to_path_buf(), quantity: quantity.into(), expected, found })
}

impl FileError {
    /// The file.
    pub fn path(&self) -> &Path {
        match self {
            Self::Sealed(error) => error.path(),
            Self::Busy { path, .. }
            | Self::Exists { path, .. }
            | Self::Unfinished { path, .. }
            | Self::NotResults { path, .. }
            | Self::Complete { path, .. }
            | Self::NotComplete { path, .. }
            | Self::NothingToResume { path, .. }
            | Self::PlaceName { path, .. }
            | Self::NulInText { path, .. }
            | Self::WrongLength { path, .. }
            | Self::NotFinite { path, .. }
            | Self::ConstantNotFinite { path, .. }
            | Self::Link { path, .. } => path,
        }
    }
}

impl Diagnostic for FileError {
    fn diagnosis(&self) -> Diagnosis {
        match self {
            Self::Sealed(error) => return error.diagnosis(),
            Self::Busy { .. }
            | Self::Exists { .. }
            | Self::Unfinished { .. }
            | Self::NotResults { .. }
            | Self::Link { .. }
            | Self::NothingToResume { .. } => Kind::Io,
            Self::NotFinite { .. } => Kind::Run,
            // A fault of a file's content, or of the names in it.
            _ => Kind::Input,
        }
        .of(self.path())
    }
}
