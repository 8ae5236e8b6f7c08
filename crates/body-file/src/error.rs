//! Errors of a body file.

use std::io;
use std::path::{Path, PathBuf};

/// Help where the file is not as it was written.
const CURE: &str = "take an unchanged copy, or make it again: flexframe reduce SCENE -o FILE";
/// Help where the system refuses.
const SYSTEM_CURE: &str = "check its name, its folder and the room on its disk";

/// An error of the writer or the reader.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BodyFileError {
    /// The HDF5 library refused an operation.
    #[error("{}: cannot {action}: {words}; {SYSTEM_CURE}", path.display())]
    Hdf5 {
        /// The file.
        path: PathBuf,
        /// The operation.
        action: String,
        /// The library's own message; as text, so that a program that only reads needs no HDF5.
        words: String,
    },
    /// The operating system refused an operation.
    #[error("{}: cannot {action}: {source}; {SYSTEM_CURE}", path.display())]
    System {
        /// The file.
        path: PathBuf,
        /// The operation.
        action: &'static str,
        /// The reason.
        source: io::Error,
    },
    /// The name of the folder is not text in UTF-8, which HDF5 wants.
    #[error(
        "{}: HDF5 makes files only in folders whose names are text in UTF-8; choose another folder, or go into this one and \
         name the file from there",
        path.display()
    )]
    NameNotUtf8 {
        /// The folder.
        path: PathBuf,
    },
    /// A file that does not begin as body files do.
    #[error(
        "{}: this is not a body file, or its beginning is damaged (one that another program has written anew, such as \
         h5repack, is not read); {CURE}",
        path.display()
    )]
    NotABody {
        /// The file.
        path: PathBuf,
    },
    /// A file of another version of the format.
    #[error(
        "{}: this is a body file of version {found}, and this program reads version {expected}; make it again: flexframe \
         reduce SCENE -o FILE",
        path.display()
    )]
    OtherVersion {
        /// The file.
        path: PathBuf,
        /// Its version.
        found: u32,
        /// The version that is read.
        expected: u32,
    },
    /// A file from a machine that has the bytes of a number in another order.
    #[error(
        "{}: this body file comes from a machine that has the bytes of a number in another order; make it again on this one: \
         flexframe reduce SCENE -o FILE",
        path.display()
    )]
    OtherMachine {
        /// The file.
        path: PathBuf,
    },
    /// A file that has been changed or damaged.
    #[error("{}: the body file is damaged, or another program has changed it: {what}; {CURE}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// The content that was found, and the one that was expected.
        what: String,
    },
    /// A dataset that is not there.
    #[error("{}: the body file has no dataset {dataset}; {CURE}", path.display())]
    Missing {
        /// The file.
        path: PathBuf,
        /// The path of the dataset.
        dataset: String,
    },
    /// Datasets that were declared otherwise than they are written.
    #[error("{}: the dataset {dataset} was declared otherwise: {what}", path.display())]
    Declared {
        /// The file.
        path: PathBuf,
        /// The path of the dataset.
        dataset: String,
        /// The difference.
        what: &'static str,
    },
}

impl BodyFileError {
    /// The file.
    pub fn path(&self) -> &Path {
        match self {
            Self::Hdf5 { path, .. }
            | Self::System { path, .. }
            | Self::NameNotUtf8 { path }
            | Self::NotABody { path }
            | Self::OtherVersion { path, .. }
            | Self::OtherMachine { path }
            | Self::Damaged { path, .. }
            | Self::Missing { path, .. }
            | Self::Declared { path, .. } => path,
        }
    }

    pub(crate) fn system(path: &Path, action: &'static str) -> impl FnOnce(io::Error) -> Self + use<> {
        let path = path.to_owned();
        move |source| Self::System { path, action, source }
    }

    pub(crate) fn hdf5<A: Into<String>>(path: &Path, action: A) -> impl FnOnce(hdf5::Error) -> Self + use<A> {
        let (path, action) = (path.to_owned(), action.into());
        move |error: hdf5::Error| Self::Hdf5 { path, action, words: error.to_string() }
    }
}
