//! `flexframe report`: a results file as one HTML page.

mod compared;
mod contents;
mod led_on;
mod quantities;

use std::path::{Path, PathBuf};

use live::LiveError;
use model::{BuildError, BuildProgress, Builder};
use report::{Report, ReportError};
use scene::SceneError;

use crate::drawn::{Drawn, DrawnError, Part};

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
        /// That of the other run.
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

/// What the page about a results file, finished or not, shows.
///
/// # Errors
/// [`HtmlReportError`].
pub fn contents(file: &Path) -> Result<Report, HtmlReportError> {
    let Drawn { results, bodies } = Drawn::open(file, Part::Surface)?;
    contents::contents(file, &results, bodies).ok_or_else(|| HtmlReportError::NoColumns { results: file.to_owned() })
}

/// The same with another run beside it: ghosts of its bodies, its courses, and their differences.
///
/// # Errors
/// [`HtmlReportError`].
pub fn compared_contents(file: &Path, other: &Path) -> Result<Report, HtmlReportError> {
    let mut name = other.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    if other.file_stem() == file.file_stem() {
        name = other.display().to_string();
    }
    let apart = || HtmlReportError::Apart { results: file.to_owned(), other: other.to_owned() };
    compared::compared(contents(file)?, contents(other)?, &name).ok_or_else(apart)
}

/// The same with the run itself: the page computes the motion, and lets it be changed. The bodies are built again from the scene
/// in the results file, with their meshes, which have to be there as they were.
///
/// # Errors
/// [`HtmlReportError`].
pub fn live_contents(
    file: &Path,
    builder: &Builder,
    progress: impl FnMut(BuildProgress),
) -> Result<Report, HtmlReportError> {
    let Drawn { results, bodies } = Drawn::open(file, Part::Surface)?;
    let led_on = led_on::led_on(file, &results, builder, progress)?;
    let no_columns = || HtmlReportError::NoColumns { results: file.to_owned() };
    let contents = contents::contents(file, &results, bodies).ok_or_else(no_columns)?;
    Ok(Report { live: Some(led_on), ..contents })
}

/// The page as a text.
///
/// # Errors
/// [`HtmlReportError::Page`].
pub fn page(report: &Report) -> Result<String, HtmlReportError> {
    Ok(report::html(report)?)
}

/// Writes the page to `path`, whole or not at all.
///
/// # Errors
/// [`HtmlReportError::Page`].
pub fn write(report: &Report, path: &Path) -> Result<(), HtmlReportError> {
    Ok(report::write(report, path)?)
}
