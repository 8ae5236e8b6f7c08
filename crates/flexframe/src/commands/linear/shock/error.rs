//! Errors of answers to a shock.

use std::path::PathBuf;

use linear::LinearError;
use shock::ShockError;

use crate::commands::linear::linearize::LinearizeError;
use crate::commands::linear::srs::SrsError;

/// An answer to a shock that could not be computed.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum ShockResponseError {
    /// The scene has no linear model.
    #[error("{0}")]
    Linearize(#[from] LinearizeError),
    /// The table cannot be read.
    #[error("{0}")]
    Table(#[from] SrsError),
    /// Not one input.
    #[error("{}: the inputs {found}: expected one, which follows the table\n = name it whole, such as --input base.acceleration.z", scene.display())]
    Inputs { scene: PathBuf, found: String },
    /// No output with a spectrum.
    #[error("{}: velocities and rates alone, of which a shock has no sums\n = ask for displacements, accelerations, coordinates of joints or stresses, or for reactions of joints where nothing is damped", scene.display())]
    Outputs { scene: PathBuf },
    /// The linear model has no real modes.
    #[error("{}: {source}", scene.display())]
    Linear { scene: PathBuf, source: Box<LinearError> },
    /// A mode has no peak under the motion of the table.
    #[error("{}: {source}", table.display())]
    Shock { table: PathBuf, source: ShockError },
}
