//! Errors of a reproduction.

use std::path::PathBuf;

use model::BuildError;
use results::FileError;
use rigid_kin::{RigidBodyError, RigidStepError};

use crate::commands::mode_shapes::ShapesError;
use crate::commands::run::RunError;
use crate::files::write_error::help_of_writing;

/// A reproduction that could not be made.
#[derive(Debug, thiserror::Error)]
pub enum PaperError {
    /// The scene could not be run.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The lumped inertia could not be found.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The results could not be read back.
    #[error(transparent)]
    File(#[from] FileError),
    /// A figure could not be drawn.
    #[error(transparent)]
    Figure(#[from] ShapesError),
    /// The rigid plate has no mass or inertia.
    #[error(transparent)]
    RigidBody(#[from] RigidBodyError),
    /// The rigid plate could not be stepped.
    #[error(transparent)]
    Step(#[from] RigidStepError),
    /// The scene lacks a point that the paper's figures need.
    #[error("{scene}: the paper's figures need the output point {point}; add it under [output.points], as in examples/plate.toml", scene = scene.display())]
    MissingPoint {
        /// The scene file.
        scene: PathBuf,
        /// The point.
        point: &'static str,
    },
    /// Another body, or other loads, than the paper's.
    #[error("{}: the paper has a free body with a mesh under dead half-sine forces; use `flexframe run` for others", scene.display())]
    NotThePlate {
        /// The scene file.
        scene: PathBuf,
    },
    /// The report cannot be written.
    #[error("{}: cannot write the report: {source}\n = {}", path.display(), help_of_writing(source))]
    Report {
        /// The report.
        path: PathBuf,
        /// The reason.
        source: std::io::Error,
    },
}
