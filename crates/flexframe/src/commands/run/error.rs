//! Errors of a run.

use std::path::PathBuf;

use advice::Refusal;
use diagnostic::{Diagnosis, Diagnostic, Kind};
use dynamics::{CheckpointError, IslandError, StepError};
use model::{BuildError, StartError};
use results::FileError;
use scene::SceneError;

use super::estimate::Estimate;
use crate::files::outputs::OutputError;
use crate::files::write_error::help_of_writing;
use crate::motion::BeginError;

/// A run that could not be done.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum RunError {
    /// The scene cannot be built.
    #[error("{0}")]
    Build(#[from] BuildError),
    /// The motion cannot start.
    #[error("{}", source.in_scene(scene))]
    Setup { scene: PathBuf, source: Box<StartError> },
    /// A step failed. `results`: the unfinished file, with the states before it; `body`: where there are several.
    #[error("{}{source} (the states before it are in {results})", prefix(body.as_deref()), results = results.display())]
    Step { results: PathBuf, body: Option<String>, source: StepError },
    /// The motion has come where the model is known to be wrong. The states before it are in the unfinished file.
    /// `results`: the unfinished file; `body`: where there are several; `time`: the first such.
    #[error("{}at time {time:.6}: {refusal} (the states up to there are in {})", prefix(body.as_deref()), results.display())]
    Refused { results: PathBuf, body: Option<String>, time: f64, refusal: Refusal },
    /// The results file cannot be written.
    #[error("{0}")]
    File(#[from] FileError),
    /// The run was asked to stop. `part`: the unfinished file, with the states up to there; `replaces`: another results file is
    /// there that it may replace.
    #[error("stopped at time {time}; go on with: flexframe resume {}{}", part.display(), if *replaces { " --overwrite" } else { "" })]
    Stopped { part: PathBuf, time: f64, replaces: bool },
    /// The scene in an unfinished file is invalid.
    #[error("{0}")]
    Scene(#[from] SceneError),
    /// The checkpoint of an unfinished file is that of another scene, or damaged. `part`: the unfinished file.
    #[error("{}: {source}", part.display())]
    Restore { part: PathBuf, source: CheckpointError },
    /// A result of now differs from that of then. `part`: the unfinished file.
    #[error(
        "{}: {what} has changed since the run began (a changed mesh or table, another version of flexframe, or another machine); a run is continued only if it stays the same bit for bit: run the scene again with --overwrite",
        part.display()
    )]
    Changed { part: PathBuf, what: &'static str },
    /// The results would go where a file is that the run reads.
    #[error("{0}")]
    Output(#[from] OutputError),
    /// The results file would be larger than anybody wants unasked.
    #[error(
        "{}: the run would write {} rows, {}\n = name fewer rows in [output], such as `interval = …`, or leave `every` and \
         `interval` out; if you want a file of more than 1 GB, allow it with --large",
        scene.display(), estimate.rows, memory::Bytes(usize::try_from(estimate.bytes).unwrap_or(usize::MAX))
    )]
    Large { scene: PathBuf, estimate: Estimate },
    /// The output folder cannot be made.
    #[error("{}: cannot make the output folder: {source}\n = {}", folder.display(), help_of_writing(source))]
    Folder { folder: PathBuf, source: std::io::Error },
}

impl From<BeginError> for RunError {
    fn from(error: BeginError) -> Self {
        match error {
            BeginError::Build(source) => Self::Build(source),
            BeginError::Start { scene, source, .. } => Self::Setup { scene, source },
        }
    }
}

impl RunError {
    /// The error without the files of the run, for those who do not keep them.
    pub(crate) fn without_files(&self) -> String {
        match self {
            Self::Step { source, body, .. } => format!("{}{source}", prefix(body.as_deref())),
            Self::Refused { time, refusal, body, .. } => {
                format!("{}at time {time:.6}: {refusal}", prefix(body.as_deref()))
            }
            other => other.to_string(),
        }
    }
}

/// The body of a message, where there are several.
fn prefix(body: Option<&str>) -> String {
    body.map_or_else(String::new, |name| format!("body {name}: "))
}

/// Reason of a run that did not come to its end.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum RunFailure {
    /// Its bodies could not be tied together.
    #[error("{0}")]
    Tie(String),
    /// It could not start.
    #[error("{0}")]
    Start(#[from] StartError),
    /// A step failed.
    #[error("{0}")]
    Step(#[from] StepError),
    /// It was stopped when the time that it may take was used up. `patience`: the time of computing that it was
    /// allowed, s; `reached`: the part of the motion, 0 to 1.
    #[error(
        "stopped at {:.2} % of the motion, when its patience of {patience} s was used up (allow more with --patience)",
        100.0 * reached
    )]
    OutOfPatience { patience: f64, reached: f64 },
}

impl From<BeginError> for RunFailure {
    fn from(error: BeginError) -> Self {
        match error {
            BeginError::Build(source) => Self::Tie(source.to_string()),
            BeginError::Start { source, .. } => Self::Start(*source),
        }
    }
}

impl From<IslandError> for RunFailure {
    fn from(failed: IslandError) -> Self {
        Self::Step(failed.source)
    }
}

impl Diagnostic for RunError {
    fn diagnosis(&self) -> Diagnosis {
        match self {
            Self::Build(error) => error.diagnosis(),
            Self::File(error) => error.diagnosis(),
            Self::Scene(error) => error.diagnosis(),
            Self::Output(error) => error.diagnosis(),
            Self::Setup { scene, source } => source.diagnosis().in_file(scene),
            Self::Folder { folder, .. } => Kind::Io.of(folder),
            Self::Step { results, .. } => Kind::Run.of(results),
            Self::Refused { results, .. } => Kind::Refused.of(results),
            Self::Stopped { part, .. } => Kind::Stopped.of(part),
            Self::Restore { part, .. } | Self::Changed { part, .. } => Kind::Input.of(part),
            Self::Large { scene, estimate } => {
                let refused = Kind::Refused.of(scene).key("output.interval").found(estimate.to_string());
                refused.expected("1 GB at the most").help("name fewer rows in [output], or allow it with --large")
            }
        }
    }
}

impl Diagnostic for RunFailure {
    fn diagnosis(&self) -> Diagnosis {
        match self {
            Self::Start(error) => error.diagnosis(),
            Self::Tie(_) | Self::Step(_) | Self::OutOfPatience { .. } => Kind::Run.alone(),
        }
    }
}
