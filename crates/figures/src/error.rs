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
    /// Nothing to draw.
    #[error("the figure \"{figure}\" has no {what}; give it at least one")]
    Empty { figure: String, what: &'static str },
    /// A NaN or an infinity in the data. `index`: from 0.
    #[error("the figure \"{figure}\" has a value that is not finite: {what}, entry {index}")]
    NotFinite { figure: String, what: String, index: usize },
    /// A logarithmic axis cannot show zero or a negative number. `index`: from 0.
    #[error(
        "the figure \"{figure}\" has a logarithmic axis but series \"{series}\" holds {value}, entry {index}; \
         leave the entry out or use a linear axis"
    )]
    NotPositive { figure: String, series: String, index: usize, value: f64 },
    /// Lists that belong together differ in length.
    #[error("the figure \"{figure}\": {what} has {found} entries where {expected} are expected")]
    WrongLength { figure: String, what: String, expected: usize, found: usize },
    /// A triangle, edge or trace names a point that is not there. `index`: from 0.
    #[error("the figure \"{figure}\": {what} names point {index}, but there are {count} points")]
    NoSuchPoint { figure: String, what: &'static str, index: usize, count: usize },
}

impl FigureError {
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
