//! Errors of a moving picture.

use std::path::PathBuf;

use dynamics::StepError;
use figures::FigureError;
use model::BuildError;
use scene::SceneError;

use super::film::FilmError;
use crate::commands::export::ExportError;
use crate::commands::run::RunError;
use crate::commands::system_modes::SystemModesError;

/// An animation that could not be made.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum AnimationError {
    /// The scene could not be run.
    #[error("{0}")]
    Run(#[from] RunError),
    /// A step failed, and no picture is drawn.
    #[error("{}: {source}", scene.display())]
    Step { scene: PathBuf, source: StepError },
    /// The film could not be made.
    #[error("{0}")]
    Film(#[from] FilmError),
    /// The stress of a body is not known.
    #[error(
        "{}: the stress of a body that deforms is not known, because its elements are not\n = leave --colour stress out", file.display()
    )]
    NoStress { file: PathBuf },
    /// A mode that is not there.
    #[error(
        "{}: --mode: found {number}, expected 1 to {modes}\n = `flexframe modes` lists them; ask for more in [modes] of the scene",
        scene.display()
    )]
    NoSuchMode { scene: PathBuf, number: usize, modes: usize },
    /// Modes of bodies that move apart.
    #[error(
        "{}: --mode: found {count} bodies or systems that move apart, each with modes of its own, expected one\n = choose a body with \
         --body NAME",
        scene.display()
    )]
    SeveralMotions { scene: PathBuf, count: usize },
    /// A body could not be built.
    #[error("{0}")]
    Build(#[from] BuildError),
    /// The scene is refused.
    #[error("{0}")]
    Scene(#[from] SceneError),
    /// The vibrations of a system could not be found.
    #[error("{0}")]
    Modes(#[from] SystemModesError),
    /// The times are not those of the run. `end`: that of the run.
    #[error(
        "--from, --to: found the times from {from} to {to}, expected a part of the run, which goes from 0 to {end}\n = \
         give --from and --to so that 0 ≤ from < to ≤ {end}, or leave them out"
    )]
    Times { from: f64, to: f64, end: f64 },
    /// The results file cannot be shown.
    #[error("{0}")]
    Export(#[from] ExportError),
    /// The picture could not be drawn.
    #[error("{0}")]
    Figure(#[from] FigureError),
}
