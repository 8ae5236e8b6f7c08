//! Errors of a figure.

use std::io;
use std::path::{Path, PathBuf};

use diagnostic::{Diagnosis, Diagnostic, Kind};
use plotters::drawing::DrawingAreaErrorKind;

/// An error of a figure.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum FigureError {
    /// The file could not be written.
    #[error("{path}: cannot write the figure: {reason}", path = .path.display())]
    Write { path: PathBuf, reason: String },
    /// The drawing library failed on a picture held in memory.
    #[error("cannot draw the figure: {reason}; its numbers are in the tables that come with it: please report this")]
    Draw { reason: String },
    /// Data that cannot be drawn, in words.
    #[error("the figure \"{figure}\" {words}")]
    Unfit { figure: String, words: String },
}

impl FigureError {
    /// Data of a figure with this title that cannot be drawn.
    pub(crate) fn unfit(figure: &str, words: impl Into<String>) -> Self {
        Self::Unfit { figure: figure.to_owned(), words: words.into() }
    }

    /// A figure without any of something.
    pub(crate) fn empty(figure: &str, what: &str) -> Self {
        Self::unfit(figure, format!("has no {what}; give it at least one"))
    }

    /// With what helps against the error.
    pub(crate) fn system(path: &Path, error: &io::Error) -> Self {
        use io::ErrorKind::*;
        let help = match error.kind() {
            StorageFull | QuotaExceeded | FileTooLarge => "make room there",
            PermissionDenied | ReadOnlyFilesystem => "choose a folder that you may write to",
            NotFound | NotADirectory => "make its folder, or check the name",
            IsADirectory => "this is a folder; name a file in it",
            _ => "check the file and its disk",
        };
        Self::Write { path: path.to_path_buf(), reason: format!("{error}; {help}") }
    }
}

/// An error of plotters.
impl<E: std::error::Error + Send + Sync> From<DrawingAreaErrorKind<E>> for FigureError {
    fn from(error: DrawingAreaErrorKind<E>) -> Self {
        Self::Draw { reason: error.to_string() }
    }
}

impl Diagnostic for FigureError {
    fn diagnosis(&self) -> Diagnosis {
        if let Self::Write { path, .. } = self { Kind::Io.of(path) } else { Kind::Run.alone() }
    }
}
