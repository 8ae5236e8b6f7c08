//! Errors of a check.

use std::path::PathBuf;

use model::{BuildError, FullError};
use results::FileError;
use scene::SceneError;

/// A check that could not be made.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum CheckError {
    /// The results file cannot be read.
    #[error("{0}")]
    File(#[from] FileError),
    /// The scene in the results file is invalid.
    #[error("{0}")]
    Scene(#[from] SceneError),
    /// The body cannot be built, as where its mesh is gone.
    #[error("{0}")]
    Build(#[from] BuildError),
    /// A result of now differs from that of the run. `what`: the part that does.
    #[error(
        "{}: {what} has changed since the run (a changed mesh or table, another version of flexframe, or another machine): a check \
         needs the body of the run\n = put the mesh back, or run the scene again",
        file.display()
    )]
    Changed { file: PathBuf, what: &'static str },
    /// There is nothing to check.
    #[error("{}: it has no rows\n = let the run come to its first row", file.display())]
    NoRows { file: PathBuf },
    /// A row that is not there. `asked`: its number; `rows`: how many there are.
    #[error("{}: there is no row {asked}, expected a number from 0 to {}", file.display(), rows - 1)]
    NoRow { file: PathBuf, asked: usize, rows: usize },
    /// The full body cannot be solved.
    #[error("{}: the check of the full body: {source}", scene.display())]
    Full { scene: PathBuf, source: Box<FullError> },
}
