//! `flexframe check`: rows of a run against the full nonlinear body.
//!
//! The model is built again from the scene in the results file and from the mesh, which has to be there as it was.

pub(crate) mod checked_rows;
mod cost;
mod joints;
pub(crate) mod report;
pub(crate) mod rows;

use std::path::Path;

use diagnostic::{Failure, Kind};
use model::Builder;
use results::{FileError, Results};

pub use checked_rows::{CheckProgress, check_run};
pub use report::{BodyCheck, CheckReport, RowCheck};
pub use rows::CheckRows;

use crate::commands::run::{bodies, metadata, system_of};
use crate::rows::columns::COLUMNS;
use crate::trust;

/// Checks a results file, finished or not.
///
/// # Errors
/// [`Failure`].
pub fn check(
    file: &Path,
    builder: &Builder,
    rows: &CheckRows,
    mut progress: impl FnMut(CheckProgress),
) -> Result<CheckReport, Failure> {
    let results = Results::open(file, &COLUMNS)?;
    let changed = |what| {
        let words = format!(
            "{what} has changed since the run (a changed mesh or table, another version of flexframe, or another machine): a check needs \
             the body of the run"
        );
        Kind::Input.of(file).help("put the mesh back, or run the scene again").says(words)
    };
    let system = system_of(&results)?.ok_or_else(|| changed("the list of bodies"))?;
    let models = builder.models(&system, |p| progress(CheckProgress::Build(p)))?;
    let of = bodies(&system.bodies, &models);
    let now = metadata(&system, &of);
    for (now, then) in now.bodies.iter().zip(&results.metadata.bodies) {
        let mut then = then.model.clone();
        then.mesh = None;
        if now.model != then {
            return Err(changed("the body"));
        }
    }
    let mut report = check_run(file, &results, &system, &models, builder, rows, progress)?;
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    report.trust = Some(trust::of_check(&results, &report, &name));
    Ok(report)
}

/// Refuses a file that no card can be written into, before the work of a check.
///
/// # Errors
/// [`FileError::NotComplete`] for an unfinished file; those of [`Results::open`].
pub fn expect_finished(file: &Path) -> Result<(), FileError> {
    match Results::is_complete(file)? {
        true => Ok(()),
        false => Err(FileError::NotComplete { path: file.to_owned() }),
    }
}

/// Writes the trust card of a report into its results file, whose run has come to its end. All else in the file stays.
///
/// # Errors
/// [`FileError`].
pub fn write_card(report: &CheckReport) -> Result<(), FileError> {
    let Some(card) = &report.trust else { return Ok(()) };
    results::replace_trust(&report.results, &COLUMNS, card.lines.clone())
}
