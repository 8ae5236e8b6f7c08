//! Errors of sealed files.

use std::io;
use std::path::{Path, PathBuf};

use diagnostic::{Diagnosis, Diagnostic, Kind};

use crate::format::Format;

/// An error of the writer or the reader.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum SealedError {
    /// The HDF5 library refused an operation. `words`: the library's own message, as text, so that a program that only
    /// reads needs no HDF5.
    #[error("{}: cannot {action}: {words}; check its folder and the room on its disk", path.display())]
    Hdf5 { path: PathBuf, action: String, words: String },
    /// The operating system refused an operation.
    #[error("{}: cannot {action}: {source}; {}", path.display(), help(source))]
    System { path: PathBuf, action: String, source: io::Error },
    /// The name of the folder is not text in UTF-8, which HDF5 wants.
    #[error(
        "{}: HDF5 makes files only in folders whose names are text in UTF-8; choose another folder, or go into this one and \
         name the file from there",
        path.display()
    )]
    NameNotUtf8 { path: PathBuf },
    /// A file that does not begin as those of its format do.
    #[error(
        "{}: this is not a {} of this version of flexframe, or its beginning is damaged; check the name (a file that another \
         program has written anew, such as h5repack, is not read), or {}",
        path.display(), format.noun, format.again
    )]
    NoSeal { path: PathBuf, format: &'static Format },
    /// A file of another version of the format.
    #[error(
        "{}: this is a {} of version {found}, and this program reads version {}; {}",
        path.display(), format.noun, format.version, format.again
    )]
    OtherVersion { path: PathBuf, format: &'static Format, found: String },
    /// A file that has been changed or damaged, or lacks a dataset.
    #[error(
        "{}: the {} is damaged, or another program has changed it: {what}; take an unchanged copy, or {}",
        path.display(), format.noun, format.again
    )]
    Damaged { path: PathBuf, format: &'static Format, what: String },
    /// Datasets that were declared otherwise than they are written.
    #[error("{}: the dataset {dataset} was declared otherwise: {what}", path.display())]
    Declared { path: PathBuf, dataset: String, what: &'static str },
}

/// The help where the system has refused something.
fn help(error: &io::Error) -> &'static str {
    use io::ErrorKind::*;
    match error.kind() {
        StorageFull | QuotaExceeded | FileTooLarge => {
            "make room there; an unfinished run can then be taken up again with `flexframe resume`"
        }
        PermissionDenied | ReadOnlyFilesystem => "choose a folder that you may write to",
        NotFound | NotADirectory => "check the name of the file and its folder",
        OutOfMemory => "end other programs, or take a machine with more memory",
        WouldBlock => "another process has the file open; wait for it or stop it",
        _ => "check the file and its disk",
    }
}

impl SealedError {
    /// The file.
    pub fn path(&self) -> &Path {
        match self {
            Self::Hdf5 { path, .. }
            | Self::System { path, .. }
            | Self::NameNotUtf8 { path }
            | Self::NoSeal { path, .. }
            | Self::OtherVersion { path, .. }
            | Self::Damaged { path, .. }
            | Self::Declared { path, .. } => path,
        }
    }

    /// Help, where the system has refused something.
    pub fn help(&self) -> Option<&'static str> {
        match self {
            Self::System { source, .. } => Some(help(source)),
            _ => None,
        }
    }

    /// Conversion for [`Result::map_err`].
    pub fn system<A: Into<String>>(path: &Path, action: A) -> impl FnOnce(io::Error) -> Self + use<A> {
        let path = path.to_owned();
        move |source| {
            // The name of a temporary file says nothing.
            let said = source.to_string();
            let source = match said.split_once(" at path ") {
                Some((reason, _)) => io::Error::new(source.kind(), reason.to_owned()),
                None => source,
            };
            Self::System { path, action: action.into(), source }
        }
    }
}

impl Diagnostic for SealedError {
    fn diagnosis(&self) -> Diagnosis {
        // A fault of a file's content, or of the names in it, is one of the input.
        let kind = if matches!(self, Self::Hdf5 { .. } | Self::System { .. }) { Kind::Io } else { Kind::Input };
        Diagnosis { help: self.help().map(str::to_owned), ..kind.of(self.path()) }
    }
}
