//! Errors of pages.

use std::path::PathBuf;

use live::LiveError;
use model::BuildError;
use report::ReportError;
use scene::SceneError;

use crate::drawn::DrawnError;

/// A page that could not be made.
#[derive(Debug, thiserror::Error)]
pub enum HtmlReportError {
    /// The results file, or the shapes of its bodies, cannot be read.
    #[error("{0}")]
    Drawn(#[from] DrawnError),
    /// A results file that lacks a column of every run.
    #[error("{}: the results lack the columns of a run; run its scene again with --overwrite", results.display())]
    NoColumns {
        /// The results file.
        results: PathBuf,
    },
    /// The page cannot be written.
    #[error("{0}")]
    Page(#[from] ReportError),
    /// The scene in the results file cannot be read.
    #[error("{0}")]
    Scene(#[from] SceneError),
    /// A body of the scene cannot be built again.
    #[error("{0}")]
    Build(#[from] BuildError),
    /// A scene that is not that of the results any more.
    #[error("{}: {what} has changed since this run; run its scene again with --overwrite, then make its live page", results.display())]
    Changed {
        /// The results file.
        results: PathBuf,
        /// The part that is another one.
        what: &'static str,
    },
    /// Runs that have no time in common.
    #[error(
        "{}: --compare: found a run whose rows are at other times, expected one with two or more rows in the time of {}\n = \
         compare runs of the same time",
        other.display(), results.display()
    )]
    Apart {
        /// The results file.
        results: PathBuf,
        /// The results file of the other run.
        other: PathBuf,
    },
    /// A run that a page cannot lead on.
    #[error("{}: no live page can be made of this run: {source}", results.display())]
    Live {
        /// The results file.
        results: PathBuf,
        /// The reason.
        source: LiveError,
    },
}
