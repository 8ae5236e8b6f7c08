//! Errors of random responses.

use std::path::PathBuf;

use figures::FigureError;
use linear::LinearError;
use report::ReportError;

use crate::commands::linear::linearize::LinearizeError;
use crate::commands::linear::spectra::SpectraError;
use crate::files::write_error::WriteError;

/// Random responses that could not be computed.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum PsdError {
    /// The scene has no linear model.
    #[error("{0}")]
    Linearize(#[from] LinearizeError),
    /// The spectra of the inputs.
    #[error("{0}")]
    Spectra(#[from] SpectraError),
    /// The linear model has no such answer.
    #[error("{}: {source}", scene.display())]
    Linear { scene: PathBuf, source: Box<LinearError> },
    /// A file cannot be written.
    #[error("{0}")]
    Write(#[from] WriteError),
    /// A chart cannot be drawn.
    #[error("{0}")]
    Figure(#[from] FigureError),
    /// The page cannot be made.
    #[error("{0}")]
    Page(#[from] ReportError),
}
