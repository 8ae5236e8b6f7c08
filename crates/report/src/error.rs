//! Errors of a report.

use std::io;
use std::path::PathBuf;

/// A report that cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// There is nothing to show.
    #[error("the report has no {what}; give it at least one")]
    Empty {
        /// The missing part.
        what: String,
    },
    /// Lists that belong together differ in length.
    #[error("the report's {what} has {found} entries where {expected} are expected")]
    WrongLength {
        /// The list.
        what: String,
        /// Length found.
        found: usize,
        /// Length expected.
        expected: usize,
    },
    /// A NaN, an infinity, or a number beyond single precision.
    #[error("the report's {what} holds {value} in entry {index} (from 0); expected a finite number below 3e38")]
    NotFinite {
        /// The list.
        what: String,
        /// Index in the list, from 0.
        index: usize,
        /// The number.
        value: f64,
    },
    /// Times that do not increase.
    #[error("the report's times do not increase: row {row} (from 0) is at {time}, and the row before it at {before}")]
    TimesNotIncreasing {
        /// The later row, from 0.
        row: usize,
        /// Its time.
        time: f64,
        /// The time of the row before.
        before: f64,
    },
    /// An attitude that is no unit quaternion.
    #[error("the report's attitude in row {row} (from 0) has the norm {norm}; expected a unit quaternion")]
    NotUnit {
        /// The row, from 0.
        row: usize,
        /// Norm found.
        norm: f64,
    },
    /// A triangle or an edge names a vertex that is not there.
    #[error("a {what} of the report's surface names vertex {index} (from 0), but there are {count} vertices")]
    NoSuchVertex {
        /// Triangle or edge.
        what: &'static str,
        /// The index, from 0.
        index: u32,
        /// Number of vertices.
        count: usize,
    },
    /// A product names a coordinate that is not there.
    #[error("a product of the report's stress names coordinate {coordinate} (from 0), but there are {count}")]
    NoSuchShape {
        /// The coordinate, from 0.
        coordinate: usize,
        /// Number of coordinates.
        count: usize,
    },
    /// More shapes than the page can draw.
    #[error("the report has {found} shapes, and the page draws {most} at the most; leave out the highest modes")]
    TooManyShapes {
        /// Number found.
        found: usize,
        /// Number that can be drawn.
        most: usize,
    },
    /// The file could not be written.
    #[error("{}: cannot write the report: {source}; check the folder and the room on its disk", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: io::Error,
    },
}
