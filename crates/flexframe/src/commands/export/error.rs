//! Errors of an export.

use std::path::PathBuf;

use results::FileError;

use crate::drawn::DrawnError;
use crate::files::outputs::OutputError;
use crate::files::write_error::WriteError;

/// An export that could not be made. Nothing has been written, unless it is of many files.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum ExportError {
    /// The results cannot be read, or the export not be written.
    #[error("{0}")]
    File(#[from] FileError),
    /// A table cannot be written.
    #[error("{0}")]
    Write(#[from] WriteError),
    /// A file that is there may not be replaced.
    #[error("{0}")]
    Output(#[from] OutputError),
    /// The shapes of the body cannot be read.
    #[error("{0}")]
    Drawn(#[from] DrawnError),
    /// The body has nodes, but no elements.
    #[error(
        "{}: no elements to show: a body of matrices has none, nor a surface, and a rigid body without a mesh has a surface alone; export \
         a table, --csv TABLE.csv, or give the body a mesh",
        path.display()
    )]
    NoElements { path: PathBuf },
    /// The body has no modes.
    #[error(
        "{}: the body has no flexible modes to export; leave --modes out, or run its scene again with flexible modes ([modes] \
         flexible = 10)",
        path.display()
    )]
    NoModes { path: PathBuf },
    /// No row is within the times asked for. `times`: the first and the last.
    #[error("{}: no row is within the times asked for; its rows are from time {} to {}: give --from and --to within them, or leave them out", path.display(), times[0], times[1])]
    NoRows { path: PathBuf, times: [f64; 2] },
    /// A column that is not in the file.
    #[error(
        "{}: there is no column \"{found}\"\n = name some of these, or beginnings of their paths: {}",
        path.display(),
        columns.join(", ")
    )]
    NoColumn { path: PathBuf, found: String, columns: Vec<String> },
}
