//! Errors of the vibrations of a system.

use std::path::PathBuf;

use dynamics::{SteadyError, StepError};
use model::BuildError;

use crate::motion::BeginError;

/// Vibrations of a system that could not be found.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum SystemModesError {
    /// A body cannot be built.
    #[error("{0}")]
    Build(#[from] BuildError),
    /// The bodies cannot be put together.
    #[error("{0}")]
    Begin(#[from] Box<BeginError>),
    /// The run does not come to the time that is asked for.
    #[error("{}: {source}", scene.display())]
    Run { scene: PathBuf, source: Box<StepError> },
    /// The system has no steady state, or its vibrations cannot be found.
    #[error("{}: {source}", scene.display())]
    Steady { scene: PathBuf, source: SteadyError },
}
