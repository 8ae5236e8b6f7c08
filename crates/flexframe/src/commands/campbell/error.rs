//! Errors of a diagram.

use std::path::PathBuf;

use dynamics::EigenError;
use figures::FigureError;
use model::BuildError;

use crate::files::write_error::WriteError;

/// Each speed takes an eigenvalue problem, and a row of a table.
pub(super) const MAX_SPEEDS: usize = 10_000;

/// A diagram that could not be made.
#[derive(Debug, thiserror::Error)]
pub enum CampbellError {
    /// The scene cannot be built, or has no modes.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The vibrations cannot be found.
    #[error("{}: {source}", scene.display())]
    Eigen {
        /// The scene file.
        scene: PathBuf,
        /// The reason.
        source: EigenError,
    },
    /// The axis has no direction.
    #[error("axis {axis:?}: expected three finite numbers that are not all zero, in the axes of the mesh")]
    Axis {
        /// The axis.
        axis: [f64; 3],
    },
    /// The speeds are no range.
    #[error(
        "speeds {start}:{end}:{count}: expected start:end:count, radians per time, with 0 ≤ start < end and a count of 2 \
         to {MAX_SPEEDS}, e.g. 0:200:50"
    )]
    Speeds {
        /// The lowest.
        start: f64,
        /// The highest.
        end: f64,
        /// How many.
        count: usize,
    },
    /// An engine order is not positive.
    #[error("order {order}: expected a positive number of times a turn, e.g. 1, 2 or 0.5")]
    Order {
        /// The order.
        order: f64,
    },
    /// The diagram cannot be drawn.
    #[error(transparent)]
    Figure(#[from] FigureError),
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}
