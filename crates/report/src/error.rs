//! Errors of a report.

use std::io;
use std::path::PathBuf;

use diagnostic::{Diagnosis, Diagnostic, Kind};
use figures::FigureError;

/// A report that cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum ReportError {
    /// There is nothing to show.
    #[error("the report has no {what}; give it at least one")]
    Empty { what: String },
    /// Lists that belong together differ in length.
    #[error("the report's {what} has {found} entries where {expected} are expected")]
    WrongLength { what: String, found: usize, expected: usize },
    /// A NaN, an infinity, or a number beyond single precision. `index`: from 0.
    #[error("the report's {what} holds {value} in entry {index} (from 0); expected a finite number below 3e38")]
    NotFinite { what: String, index: usize, value: f64 },
    /// Times that do not increase. `row`: the later one, from 0.
    #[error("the report's times do not increase: row {row} (from 0) is at {time}, and the row before it at {before}")]
    TimesNotIncreasing { row: usize, time: f64, before: f64 },
    /// An attitude that is no unit quaternion. `row`: from 0.
    #[error("the report's attitude in row {row} (from 0) has the norm {norm}; expected a unit quaternion")]
    NotUnit { row: usize, norm: f64 },
    /// A triangle or an edge names a vertex that is not there. `index`: from 0.
    #[error("a {what} of the report's surface names vertex {index} (from 0), but there are {count} vertices")]
    NoSuchVertex { what: &'static str, index: u32, count: usize },
    /// A product names a coordinate that is not there. `coordinate`: from 0.
    #[error("a product of the report's stress names coordinate {coordinate} (from 0), but there are {count}")]
    NoSuchShape { coordinate: usize, count: usize },
    /// More shapes than the page can draw.
    #[error("the report has {found} shapes, and the page draws {most} at the most; leave out the highest modes")]
    TooManyShapes { found: usize, most: usize },
    /// A chart cannot be drawn.
    #[error(transparent)]
    Figure(#[from] FigureError),
    /// The file could not be written.
    #[error("{}: cannot write the report: {source}; check the folder and the room on its disk", path.display())]
    Write { path: PathBuf, source: io::Error },
}

impl Diagnostic for ReportError {
    fn diagnosis(&self) -> Diagnosis {
        match self {
            Self::Write { path, .. } => Kind::Io.of(path),
            Self::Figure(source) => source.diagnosis(),
            _ => Kind::Run.alone(),
        }
    }
}
