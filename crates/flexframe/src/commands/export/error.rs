//! Errors of an export.

use std::path::PathBuf;

use results::FileError;

use crate::drawn::DrawnError;
use crate::files::outputs::OutputError;
use crate::files::write_error::WriteError;

/// An export that could not be made. Nothing has been written, unless it is of many files.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The results cannot be read, or the export not be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// A table cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A file that is there may not be replaced.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The shapes of the body cannot be read.
    #[error(transparent)]
    Drawn(#[from] DrawnError),
    /// There is no mesh to show.
    #[error("{}: a rigid body without a mesh has no surface to export; give it a mesh and `flexible = 0`", path.display())]
    NoMesh {
        /// The results file.
        path: PathBuf,
    },
    /// The body has nodes, but no elements.
    #[error(
        "{}: the elements and the surface of a body of matrices are not known; export a table, --csv TABLE.csv, or give the body a mesh",
        path.display()
    )]
    NoElements {
        /// The results file.
        path: PathBuf,
    },
    /// The body has no modes.
    #[error(
        "{}: the body has no flexible modes to export; leave --modes out, or run its scene again with flexible modes ([modes] \
         flexible = 10)",
        path.display()
    )]
    NoModes {
        /// The results file.
        path: PathBuf,
    },
    /// No row is within the times asked for.
    #[error("{}: no row is within the times asked for; its rows are from time {} to {}: give --from and --to within them, or leave them out", path.display(), times[0], times[1])]
    NoRows {
        /// The results file.
        path: PathBuf,
        /// First and last time.
        times: [f64; 2],
    },
    /// A column that is not in the file.
    #[error(
        "{}: there is no column \"{found}\"\n = name some of these, or beginnings of their paths: {}",
        path.display(),
        columns.join(", ")
    )]
    NoColumn {
        /// The results file.
        path: PathBuf,
        /// The column asked for.
        found: String,
        /// The columns that there are.
        columns: Vec<String>,
    },
}
