//! Errors of a price list.

use std::path::PathBuf;

use figures::FigureError;
use model::BuildError;

use crate::commands::run::RunFailure;
use crate::files::outputs::OutputError;
use crate::files::write_error::WriteError;

/// A price list that could not be made.
#[derive(Debug, thiserror::Error)]
pub enum CostError {
    /// The scene cannot be built.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// No body was given.
    #[error("there is no body to run")]
    NoBody,
    /// No run of the reference came to its end.
    #[error(
        "{scene}: no reference can be made: a run of {steps} steps of the exponential scheme failed: {failure}; make the \
         run shorter, or give more time with --patience",
        scene = scene.display()
    )]
    Reference {
        /// The scene file.
        scene: PathBuf,
        /// Steps of the last try.
        steps: u64,
        /// Reason of the failure.
        failure: RunFailure,
    },
    /// The diagram cannot be drawn.
    #[error(transparent)]
    Figure(#[from] FigureError),
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A file that is there may not be replaced.
    #[error(transparent)]
    Output(#[from] OutputError),
}
