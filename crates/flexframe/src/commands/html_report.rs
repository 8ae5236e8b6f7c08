//! `flexframe report`: a results file as one HTML page.

mod contents;
mod quantities;

use std::path::{Path, PathBuf};

use report::{Report, ReportError};

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
}

/// Reads a results file, finished or not, and writes a page about it to `path`.
///
/// # Errors
/// [`HtmlReportError`].
pub fn write(file: &Path, path: &Path) -> Result<(), HtmlReportError> {
    Ok(report::write(&contents_of(file)?, path)?)
}

/// The same page as a text.
///
/// # Errors
/// [`HtmlReportError`].
pub fn page(file: &Path) -> Result<String, HtmlReportError> {
    Ok(report::html(&contents_of(file)?)?)
}

fn contents_of(file: &Path) -> Result<Report, HtmlReportError> {
    let Drawn { results, bodies } = Drawn::open(file, Part::Surface)?;
    contents::contents(file, &results, bodies).ok_or_else(|| HtmlReportError::NoColumns { results: file.to_owned() })
}
