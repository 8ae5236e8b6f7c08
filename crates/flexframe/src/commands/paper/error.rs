//! Errors of a reproduction.

use std::path::PathBuf;

use model::BuildError;
use results::FileError;
use rigid_kin::{RigidBodyError, RigidStepError};

use crate::commands::pictures::mode_shapes::ShapesError;
use crate::commands::run::RunError;
use crate::files::write_error::help_of_writing;

/// A reproduction that could not be made.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum PaperError {
    /// The scene could not be run.
    #[error("{0}")]
    Run(#[from] RunError),
    /// The lumped inertia could not be found.
    #[error("{0}")]
    Build(#[from] BuildError),
    /// The results could not be read back.
    #[error("{0}")]
    File(#[from] FileError),
    /// A figure could not be drawn.
    #[error("{0}")]
    Figure(#[from] ShapesError),
    /// The rigid plate has no mass or inertia.
    #[error("{0}")]
    RigidBody(#[from] RigidBodyError),
    /// The rigid plate could not be stepped.
    #[error("{0}")]
    Step(#[from] RigidStepError),
    /// The scene lacks a point that the paper's figures need.
    #[error("{scene}: the paper's figures need the output point {point}; add it under [output.points], as in examples/plate.toml", scene = scene.display())]
    MissingPoint { scene: PathBuf, point: &'static str },
    /// Another body, or other loads, than the paper's.
    #[error("{}: the paper has a free body with a mesh under dead half-sine forces; use `flexframe run` for others", scene.display())]
    NotThePlate { scene: PathBuf },
    /// The report cannot be written.
    #[error("{}: cannot write the report: {source}\n = {}", path.display(), help_of_writing(source))]
    Report { path: PathBuf, source: std::io::Error },
}
