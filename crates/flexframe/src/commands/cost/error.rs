//! Errors of a price list.

use std::path::PathBuf;

use figures::FigureError;
use model::{BuildError, StartError};

use crate::commands::run::RunFailure;
use crate::files::outputs::OutputError;
use crate::files::write_error::WriteError;

/// A price list that could not be made.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum CostError {
    /// The scene cannot be built.
    #[error("{0}")]
    Build(#[from] BuildError),
    /// A body does not move alone.
    #[error("{0}")]
    Start(#[from] StartError),
    /// No run of the reference came to its end. `steps`: those of the last try.
    #[error(
        "{scene}: no reference can be made: a run of {steps} steps of the exponential scheme failed: {source}; make the \
         run shorter, or give more time with --patience",
        scene = scene.display()
    )]
    Reference { scene: PathBuf, steps: u64, source: RunFailure },
    /// The diagram cannot be drawn.
    #[error("{0}")]
    Figure(#[from] FigureError),
    /// A file cannot be written.
    #[error("{0}")]
    Write(#[from] WriteError),
    /// A file that is there may not be replaced.
    #[error("{0}")]
    Output(#[from] OutputError),
}
