//! Errors of a results file.

use std::fs::OpenOptions;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// An error of the HDF5 writer or reader.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// The HDF5 library refused an operation.
    #[error("{path}: cannot {action}: {source}; check its folder and the room on its disk", path = .path.display())]
    Hdf5 {
        /// The results file.
        path: PathBuf,
        /// The operation, for instance "create dataset modal/displacement".
        action: String,
        /// The library's own message.
        source: hdf5::Error,
    },
    /// The operating system refused an operation.
    #[error("{path}: cannot {action}: {reason}; {help}", path = .path.display())]
    System {
        /// The results file.
        path: PathBuf,
        /// The operation.
        action: String,
        /// The system's own message.
        reason: String,
        /// Help for the user.
        help: &'static str,
    },
    /// Another process has the file open for writing.
    #[error(
        "{path}: another run is writing this file, or another program has it open; wait for it, stop it, or choose another folder",
        path = .path.display()
    )]
    Busy {
        /// The unfinished file.
        path: PathBuf,
    },
    /// A run of the same name was cut off.
    #[error(
        "{path}: this is an unfinished run; go on with it (`flexframe resume {path}`), or throw it away with --overwrite",
        path = .path.display()
    )]
    Unfinished {
        /// The unfinished file.
        path: PathBuf,
    },
    /// Something else is where the results would go.
    #[error(
        "{path}: the file there is not a results file of flexframe; choose another folder, move it away, or replace it with --overwrite (a folder never)",
        path = .path.display()
    )]
    NotResults {
        /// Where the results would go.
        path: PathBuf,
    },
    /// The run to be resumed has come to its end.
    #[error("{path}: this run is complete; there is nothing to resume", path = .path.display())]
    Complete {
        /// The results file.
        path: PathBuf,
    },
    /// There is no unfinished run.
    #[error(
        "{path}: there is no unfinished run ({part} does not exist); check the name, or begin with `flexframe run`",
        path = .path.display(),
        part = .part.display()
    )]
    NothingToResume {
        /// The results file.
        path: PathBuf,
        /// The unfinished file that is not there.
        part: PathBuf,
    },
    /// The name of a body, an output point or a support that cannot be part of a path, or occurs twice.
    #[error(
        "{path}: the {kind} \"{name}\" cannot be stored: {reason}; give it another name",
        path = .path.display()
    )]
    PlaceName {
        /// The results file.
        path: PathBuf,
        /// "body", "output point" or "support".
        kind: &'static str,
        /// The name as given.
        name: String,
        /// Reason of the refusal.
        reason: &'static str,
    },
    /// A text holds a NUL character, at which HDF5 strings end.
    #[error("{path}: the text of `{attribute}` holds a NUL character; remove it", path = .path.display())]
    NulInText {
        /// The results file.
        path: PathBuf,
        /// The attribute that was to hold the text.
        attribute: String,
    },
    /// A row or the metadata have a list of the wrong length.
    #[error("{path}: {quantity} has {found} values where {expected} are expected", path = .path.display())]
    WrongLength {
        /// The results file.
        path: PathBuf,
        /// Name of the quantity.
        quantity: String,
        /// The length that the metadata ask for.
        expected: usize,
        /// The length given.
        found: usize,
    },
    /// A NaN or an infinity in a row; the row is not stored, those before it are.
    #[error(
        "{path}: {quantity} is {value} at time {time}: the run has become unstable there; \
         use a smaller step (the rows before it are in the file)",
        path = .path.display()
    )]
    NotFinite {
        /// The results file.
        path: PathBuf,
        /// Time of the row, in the run's unit of time.
        time: f64,
        /// Name of the dataset that was to hold the value.
        quantity: String,
        /// The value.
        value: f64,
    },
    /// A constant of the run that is not finite.
    #[error("{path}: {quantity} is {value}, expected a finite number; check the scene's numbers and units", path = .path.display())]
    ConstantNotFinite {
        /// The results file.
        path: PathBuf,
        /// Name of the dataset or attribute that was to hold it.
        quantity: String,
        /// The value.
        value: f64,
    },
    /// A symbolic link is where a results file would go.
    #[error(
        "{path}: this is a symbolic link (to {target}); results are not written through a link, nor in its place: remove \
         it, move it away, or choose another folder",
        path = .path.display(),
        target = .target.display()
    )]
    Link {
        /// The link.
        path: PathBuf,
        /// Its target.
        target: PathBuf,
    },
    /// A file is where a results file or an export would go.
    #[error("{path}: this file is there already; choose another name or folder, or replace it with --overwrite", path = .path.display())]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// The name of the folder is not text in UTF-8, which HDF5 wants.
    #[error(
        "{path}: HDF5 makes files only in folders whose names are text in UTF-8; choose another folder, or go into this one \
         and name the files from there",
        path = .path.display()
    )]
    NameNotUtf8 {
        /// The folder.
        path: PathBuf,
    },
    /// A file to be read that does not begin as results files do.
    #[error(
        "{path}: this is not a results file of this version of flexframe, or its beginning is damaged; check the name (a file \
         that another program has written anew, such as h5repack, is not read)",
        path = .path.display()
    )]
    NoSeal {
        /// The file.
        path: PathBuf,
    },
    /// A file of another version of the format.
    #[error(
        "{path}: this is a results file of version {found}, and this program reads version {expected}, in which a file has a \
         group for each body; run its scene again with --overwrite",
        path = .path.display()
    )]
    OtherVersion {
        /// The file.
        path: PathBuf,
        /// Its version.
        found: String,
        /// The version that is read.
        expected: &'static str,
    },
    /// A results file that has been changed or damaged.
    #[error(
        "{path}: the file is damaged, or another program has changed it: {what}; take an unchanged copy, or run its scene \
         again with --overwrite",
        path = .path.display()
    )]
    Damaged {
        /// The file.
        path: PathBuf,
        /// The content found, and the one expected.
        what: String,
    },
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
            Self::Hdf5 { path, .. }
            | Self::System { path, .. }
            | Self::Busy { path, .. }
            | Self::Exists { path, .. }
            | Self::Unfinished { path, .. }
            | Self::NotResults { path, .. }
            | Self::Complete { path, .. }
            | Self::NothingToResume { path, .. }
            | Self::PlaceName { path, .. }
            | Self::NulInText { path, .. }
            | Self::WrongLength { path, .. }
            | Self::NotFinite { path, .. }
            | Self::NoSeal { path, .. }
            | Self::OtherVersion { path, .. }
            | Self::Damaged { path, .. }
            | Self::ConstantNotFinite { path, .. }
            | Self::Link { path, .. }
            | Self::NameNotUtf8 { path, .. } => path,
        }
    }

    /// Help, where the system has refused something.
    pub fn help(&self) -> Option<&'static str> {
        match self {
            Self::System { help, .. } => Some(help),
            _ => None,
        }
    }

    /// Conversion for [`Result::map_err`]. Where the operating system has refused something, it says so in the library's
    /// message.
    pub(crate) fn hdf5(path: &Path, action: impl Into<String>) -> impl FnOnce(hdf5::Error) -> Self {
        let (path, action) = (path.to_path_buf(), action.into());
        move |source| {
            let errno = source.stack().and_then(|stack| {
                stack.iter().find_map(|frame| {
                    let (_, rest) = frame.desc().split_once("errno = ")?;
                    rest.split(|c: char| !c.is_ascii_digit()).next()?.parse().ok()
                })
            });
            match errno {
                Some(errno) => Self::system(&path, action, &io::Error::from_raw_os_error(errno)),
                None => Self::Hdf5 { path, action, source },
            }
        }
    }

    /// The HDF5 library may lose the system's reason on its way. Where it could not write the temporary file `file`, the
    /// system says it again to who tries the same.
    pub(crate) fn with_reason_from_system(self, file: &Path) -> Self {
        let Self::Hdf5 { path, action, source } = self else { return self };
        let again = OpenOptions::new().append(true).open(file).and_then(|mut file| {
            file.write_all(&[0; 1 << 16])?;
            file.sync_data()
        });
        match again {
            Err(error) => Self::system(&path, action, &error),
            Ok(()) => Self::Hdf5 { path, action, source },
        }
    }

    /// With what helps against the error.
    pub(crate) fn system(path: &Path, action: impl Into<String>, error: &io::Error) -> Self {
        use io::ErrorKind::*;
        let help = match error.kind() {
            StorageFull | QuotaExceeded | FileTooLarge => {
                "make room there; an unfinished run can then be taken up again with `flexframe resume`"
            }
            PermissionDenied | ReadOnlyFilesystem => "choose a folder that you may write to",
            NotFound | NotADirectory => "check the name of the folder",
            OutOfMemory => "end other programs, or take a machine with more memory",
            WouldBlock => "another process has the file open; wait for it or stop it",
            _ => "check the file and its disk",
        };
        let reason = error.to_string();
        // The name of a temporary file says nothing.
        let reason = reason.split(" at path ").next().unwrap_or_default().to_owned();
        Self::System { path: path.to_path_buf(), action: action.into(), reason, help }
    }
}
