//! Errors of a diagram.

use std::path::PathBuf;

use dynamics::{EigenError, RotorError, SteadyError};
use figures::FigureError;
use model::{BuildError, FullError};
use nonlinear::NonlinearError;

use crate::commands::system_modes::SystemModesError;
use crate::files::write_error::WriteError;

/// Each speed takes an eigenvalue problem, and a row of a table.
pub(super) const MAX_SPEEDS: usize = 10_000;

/// A diagram that could not be made.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum CampbellError {
    /// The scene cannot be built, or has no modes.
    #[error("{0}")]
    Build(#[from] BuildError),
    /// The vibrations cannot be found.
    #[error("{}: {source}", scene.display())]
    Eigen { scene: PathBuf, source: EigenError },
    /// The system cannot be put together.
    #[error("{0}")]
    System(#[from] SystemModesError),
    /// The system has no vibrations in this spin.
    #[error("{}: at {speed} rad per time: {source}", scene.display())]
    Steady { scene: PathBuf, speed: f64, source: SteadyError },
    /// Bodies that cannot spin together, nor one of them alone.
    #[error("{}: joint {joint:?}, whose other bodies are held: {source}", scene.display())]
    Rotor { scene: PathBuf, joint: String, source: Box<RotorError> },
    /// A body without elements has no rest in a spin.
    #[error(
        "{}: found {found}; expected one with a mesh, whose rest at each speed can be found; help: leave `--about-rest` out", scene.display()
    )]
    NoFullBody { scene: PathBuf, found: &'static str },
    /// The full body has all effects of a spin.
    #[error(
        "{}: found an effect of the spin that is off, `coriolis`, `deformed_inertia` or `geometric_stiffening` in [effects]; expected all of \
         them with `--about-rest always`, since the full body has them; help: leave them on, or give `--about-rest never`", scene.display()
    )]
    WithoutEffect { scene: PathBuf },
    /// The full body cannot be made.
    #[error("{}: {source}", scene.display())]
    Full { scene: PathBuf, source: Box<FullError> },
    /// The bent body has no rest at a speed, or no vibrations about it.
    #[error(
        "{}: at {speed} rad per time: {source}; help: end the speeds before this one, or take vibrations about the undeformed body \
         with `--about-rest never`", scene.display()
    )]
    Bent { scene: PathBuf, speed: f64, source: Box<NonlinearError> },
    /// The axis of the spin of a system is not known.
    #[error(
        "{}: {found}; expected --axis, an axis through the center of mass, or --joint, whose axis it is: one of {}", scene.display(), joints.join(", ")
    )]
    NoAxis { scene: PathBuf, found: String, joints: Vec<String> },
    /// The axis has no direction.
    #[error("axis {axis:?}: expected three finite numbers that are not all zero, in the axes of the mesh")]
    Axis { axis: [f64; 3] },
    /// The speeds are no range.
    #[error(
        "speeds {start}:{end}:{count}: expected start:end:count, radians per time, with 0 ≤ start < end and a count of 2 \
         to {MAX_SPEEDS}, e.g. 0:200:50"
    )]
    Speeds { start: f64, end: f64, count: usize },
    /// An engine order is not positive.
    #[error("order {order}: expected a positive number of times a turn, e.g. 1, 2 or 0.5")]
    Order { order: f64 },
    /// The diagram cannot be drawn.
    #[error("{0}")]
    Figure(#[from] FigureError),
    /// A file cannot be written.
    #[error("{0}")]
    Write(#[from] WriteError),
}
