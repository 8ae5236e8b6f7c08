//! `flexframe report`: a results file as one HTML page.

mod compared;
mod contents;
mod error;
mod led_on;
mod quantities;

use std::path::Path;

use model::{BuildProgress, Builder};
use report::Report;

use crate::drawn::{Drawn, Part};
pub use error::HtmlReportError;

/// Contents of the page about a results file, finished or not.
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
