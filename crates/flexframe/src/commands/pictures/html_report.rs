//! `flexframe report`: a results file as one HTML page.

mod compared;
mod contents;
mod led_on;
mod quantities;

use std::path::Path;

use diagnostic::{Failure, Kind};
use model::{BuildProgress, Builder};
use report::RunPage;

use crate::drawn::{Drawn, Part};

/// Contents of the page about a results file, finished or not.
///
/// # Errors
/// [`Failure`].
pub fn contents(file: &Path) -> Result<RunPage, Failure> {
    let Drawn { results, bodies } = Drawn::open(file, Part::Surface)?;
    contents::contents(file, &results, bodies).ok_or_else(|| no_columns(file))
}

fn no_columns(file: &Path) -> Failure {
    Kind::Input.of(file).help("run its scene again with --overwrite").says("the results lack the columns of a run")
}

/// The same with another run beside it: ghosts of its bodies, its courses, and their differences.
///
/// # Errors
/// [`Failure`].
pub fn compared_contents(file: &Path, other: &Path) -> Result<RunPage, Failure> {
    let mut name = other.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    if other.file_stem() == file.file_stem() {
        name = other.display().to_string();
    }
    compared::compared(contents(file)?, contents(other)?, &name).ok_or_else(|| {
        let expected = format!("one with two or more rows in the time of {}", file.display());
        let wrong = Kind::Input.of(other).key("--compare").found("a run whose rows are at other times");
        wrong.expected(expected).help("compare runs of the same time").into()
    })
}

/// The same with the run itself: the page computes the motion, and lets it be changed. The bodies are built again from the scene
/// in the results file, with their meshes, which have to be there as they were.
///
/// # Errors
/// [`Failure`].
pub fn live_contents(file: &Path, builder: &Builder, progress: impl FnMut(BuildProgress)) -> Result<RunPage, Failure> {
    let Drawn { results, bodies } = Drawn::open(file, Part::Surface)?;
    let led_on = led_on::led_on(file, &results, builder, progress)?;
    let contents = contents::contents(file, &results, bodies).ok_or_else(|| no_columns(file))?;
    Ok(RunPage { live: Some(led_on), ..contents })
}

/// The page as a text.
///
/// # Errors
/// Contents that are no page, and errors of the system.
pub fn page(report: &RunPage) -> Result<String, Failure> {
    report::html(report)
}

/// Writes the page to `path`, whole or not at all.
///
/// # Errors
/// Contents that are no page, and errors of the system.
pub fn write(report: &RunPage, path: &Path) -> Result<(), Failure> {
    report::write(report, path)
}
