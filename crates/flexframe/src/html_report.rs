//! `flexframe report`: a results file as one HTML page.

mod contents;
mod quantities;

use std::path::{Path, PathBuf};

use report::{Report, ReportError};
use scene::{BuildProgress, Cache};

use crate::reopened::{ReopenError, Reopened};
use crate::run;

/// A page that could not be made.
#[derive(Debug, thiserror::Error)]
pub enum HtmlReportError {
    /// The results file cannot be read, or its body not be made again.
    #[error(transparent)]
    Reopen(#[from] ReopenError),
    /// A result of now differs from that of then: the shapes may be others.
    #[error(
        "{}: {what} has changed since the run began (a changed mesh or table, another version of flexframe, or another machine), so that its shapes may be others: run the scene again",
        results.display()
    )]
    Changed {
        /// The results file.
        results: PathBuf,
        /// The changed part.
        what: &'static str,
    },
    /// The page cannot be written.
    #[error(transparent)]
    Page(#[from] ReportError),
}

/// Reads a results file, finished or not, and writes a page about it to `path`. The shapes come from the scene in the
/// file, whose mesh is looked for where it was.
///
/// # Errors
/// [`HtmlReportError`].
pub fn write(
    file: &Path,
    path: &Path,
    cache: &Cache,
    progress: impl FnMut(BuildProgress),
) -> Result<(), HtmlReportError> {
    Ok(report::write(&contents_of(file, cache, progress)?, path)?)
}

/// The same page as a text.
///
/// # Errors
/// [`HtmlReportError`].
pub fn page(file: &Path, cache: &Cache, progress: impl FnMut(BuildProgress)) -> Result<String, HtmlReportError> {
    Ok(report::html(&contents_of(file, cache, progress)?)?)
}

fn contents_of(file: &Path, cache: &Cache, progress: impl FnMut(BuildProgress)) -> Result<Report, HtmlReportError> {
    let Reopened { results, scene, model } = Reopened::open(file, cache, progress)?;
    let changed = |what| HtmlReportError::Changed { results: file.to_owned(), what };
    let now = run::metadata(&scene, &model);
    if now.program_version != results.metadata.program_version {
        return Err(changed("the version of flexframe"));
    }
    if now.body != results.metadata.body {
        return Err(changed("the body"));
    }
    contents::contents(file, &results, &scene, &model).ok_or_else(|| changed("the set of columns"))
}
