//! Bodies that cannot be handed over.

use model::BuildError;
use scene::SceneError;

use crate::files::write_error::WriteError;

/// A body that could not be written in the form of another program.
#[derive(Debug, thiserror::Error)]
pub enum HandOverError {
    /// The body has nothing that the form could hold.
    #[error("{0}")]
    Scene(#[from] SceneError),
    /// The body cannot be built.
    #[error("{0}")]
    Build(#[from] BuildError),
    /// The file cannot be written.
    #[error("{0}")]
    Write(#[from] WriteError),
}
