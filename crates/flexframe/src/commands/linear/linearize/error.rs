//! Errors of linear models of scenes.

use std::path::PathBuf;

use dynamics::{LoadedError, SetupError, SteadyError, StepError};
use figures::FigureError;
use linear::LinearError;
use model::BuildError;
use report::ReportError;

use crate::files::write_error::WriteError;
use crate::motion::BeginError;

/// A linear model that could not be made.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum LinearizeError {
    /// The scene cannot be built.
    #[error("{0}")]
    Build(#[from] BuildError),
    /// The bodies cannot be put together.
    #[error("{0}")]
    Begin(#[from] Box<BeginError>),
    /// A state that is not steady.
    #[error("{}: {source}", scene.display())]
    Steady { scene: PathBuf, source: Box<SteadyError> },
    /// The body finds no rest under its loads.
    #[error("{}: {source}", scene.display())]
    Rest { scene: PathBuf, source: Box<LoadedError> },
    /// The linear model has no such answer.
    #[error("{}: {source}", scene.display())]
    Linear { scene: PathBuf, source: Box<LinearError> },
    /// A state that is not made linear.
    #[error("{}: {found}\n = {help}", scene.display())]
    Refused { scene: PathBuf, found: String, help: &'static str },
    /// An input or an output that is not there.
    #[error("{}: no {what} `{found}`; expected one of {}", scene.display(), known.join(", "))]
    NoChannel { scene: PathBuf, what: &'static str, found: String, known: Vec<String> },
    /// A time that the run does not have.
    #[error("{}: time {time}: expected 0 to {end}, the end of the run", scene.display())]
    Time { scene: PathBuf, time: f64, end: f64 },
    /// The state of the run is none of the system that is made linear.
    #[error("{}: {source}", scene.display())]
    State { scene: PathBuf, source: Box<SetupError> },
    /// The run to the state fails.
    #[error("{}: {source}", scene.display())]
    Run { scene: PathBuf, source: Box<StepError> },
    /// A model without inputs or outputs.
    #[error("{}: no {what}\n = {help}", scene.display())]
    Nothing { scene: PathBuf, what: &'static str, help: &'static str },
    /// The file of a linear model has another ending.
    #[error("{}: expected a file that ends in .mat or .json", path.display())]
    Ending { path: PathBuf },
    /// The frequencies are no range.
    #[error(
        "frequencies {start}:{end}:{count}: expected start:end:count with 0 ≤ start < end and a count of 2 to 1 000 000, e.g. 1:500:1000"
    )]
    Frequencies { start: f64, end: f64, count: usize },
    /// A file cannot be written.
    #[error("{0}")]
    Write(#[from] WriteError),
    /// A chart cannot be drawn.
    #[error("{0}")]
    Figure(#[from] FigureError),
    /// The page cannot be made.
    #[error("{0}")]
    Page(#[from] ReportError),
}
