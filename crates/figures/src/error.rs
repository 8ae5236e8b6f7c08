//! Errors of a figure.

use std::io;
use std::path::{Path, PathBuf};

use plotters::drawing::DrawingAreaErrorKind;

/// An error of a figure.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FigureError {
    /// The file could not be written.
    #[error("{path}: cannot write the figure: {reason}", path = .path.display())]
    Write {
        /// The figure's file.
        path: PathBuf,
        /// The message of the drawing library or the operating system.
        reason: String,
    },
    /// The drawing library failed on a picture held in memory.
    #[error("cannot draw the figure: {reason}; its numbers are in the tables that come with it: please report this")]
    Draw {
        /// The message of the drawing library.
        reason: String,
    },
    /// There is nothing to draw.
    #[error("the figure \"{figure}\" has no {what}; give it at least one")]
    Empty {
        /// Title of the figure.
        figure: String,
        /// The missing part.
        what: &'static str,
    },
    /// A NaN or an infinity in the data.
    #[error("the figure \"{figure}\" has a value that is not finite: {what}, entry {index}")]
    NotFinite {
        /// Title of the figure.
        figure: String,
        /// The series, panel or frame.
        what: String,
        /// Index in it, from 0.
        index: usize,
    },
    /// A logarithmic axis cannot show zero or a negative number.
    #[error(
        "the figure \"{figure}\" has a logarithmic axis but series \"{series}\" holds {value}, entry {index}; \
         leave the entry out or use a linear axis"
    )]
    NotPositive {
        /// Title of the figure.
        figure: String,
        /// Label of the series.
        series: String,
        /// Index in the series, from 0.
        index: usize,
        /// The value.
        value: f64,
    },
    /// Lists that belong together differ in length.
    #[error("the figure \"{figure}\": {what} has {found} entries where {expected} are expected")]
    WrongLength {
        /// Title of the figure.
        figure: String,
        /// The list.
        what: String,
        /// Length expected.
        expected: usize,
        /// Length found.
        found: usize,
    },
    /// A triangle, edge or trace names a point that is not there.
    #[error("the figure \"{figure}\": {what} names point {index}, but there are {count} points")]
    NoSuchPoint {
        /// Title of the figure.
        figure: String,
        /// The list that names it.
        what: &'static str,
        /// The index, from 0.
        index: usize,
        /// The number of points.
        count: usize,
    },
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
