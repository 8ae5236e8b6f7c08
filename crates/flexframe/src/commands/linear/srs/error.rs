//! Errors of shock response spectra.

use std::io;
use std::path::PathBuf;

use dynamics::SetupError;
use figures::FigureError;
use report::ReportError;
use scene::PointsError;
use shock::ShockError;

use crate::files::write_error::WriteError;

/// Each frequency takes a run of an oscillator for each damping ratio.
pub(super) const MAX_FREQUENCIES: usize = 10_000;
/// More lines than this have no colours of their own.
pub(super) const MAX_DAMPINGS: usize = 7;

/// Spectra that could not be made.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum SrsError {
    /// The table cannot be read.
    #[error("{}: the table cannot be read: {source}\n = name a CSV file of times and accelerations of the base", path.display())]
    Unreadable { path: PathBuf, source: io::Error },
    /// The table has a line that is no point, or no two of them.
    #[error("{}:{}: {source}", path.display(), source.line)]
    Points { path: PathBuf, source: PointsError },
    /// The points have no cubics between them.
    #[error("{}: {source}", path.display())]
    Table { path: PathBuf, source: SetupError },
    /// The motion or the settings have no spectrum.
    #[error("{}: {source}", table.display())]
    Shock { table: PathBuf, source: ShockError },
    /// The frequencies are no range.
    #[error(
        "frequencies {start}:{end}:{count}: expected start:end:count, cycles per time, with 0 < start < end and a count of 2 to \
         {MAX_FREQUENCIES}, e.g. 1:2000:200"
    )]
    Frequencies { start: f64, end: f64, count: usize },
    /// Too few or too many damping ratios.
    #[error("{count} damping ratios: expected 1 to {MAX_DAMPINGS}, e.g. 0.02,0.05")]
    Dampings { count: usize },
    /// The diagram cannot be drawn.
    #[error("{0}")]
    Figure(#[from] FigureError),
    /// The page cannot be made.
    #[error("{0}")]
    Page(#[from] ReportError),
    /// A file cannot be written.
    #[error("{0}")]
    Write(#[from] WriteError),
}
