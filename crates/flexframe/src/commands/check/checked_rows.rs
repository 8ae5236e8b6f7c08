//! Rows of a run whose models are there, checked.

use std::path::Path;

use diagnostic::{Diagnostic, Failure};
use model::{BuildProgress, Builder, Checker, FullError, Model};
use nonlinear::StateErrorSettings;
use results::Results;
use scene::{Body, Scene};

use super::joints::Ties;
use super::report::{BodyCheck, CheckReport, DEAR, RIGID, RowCheck};
use super::rows::{self, CheckRows};

/// How far a check has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CheckProgress {
    /// The model is being built.
    Build(BuildProgress),
    /// Rows are being checked, done of all.
    Rows {
        /// Done.
        done: usize,
        /// All.
        total: usize,
    },
}

/// The reason that a body which bends is not checked on demand.
fn without_elements(body: &Body) -> String {
    format!("it is {}", body.source.not_by_elements().unwrap_or("a body without elements"))
}

/// Checks the rows of a run whose models are there.
///
/// # Errors
/// [`Failure`].
pub fn check_run(
    file: &Path,
    results: &Results,
    scene: &Scene,
    models: &[Model],
    builder: &Builder,
    rows: &CheckRows,
    mut progress: impl FnMut(CheckProgress),
) -> Result<CheckReport, Failure> {
    let bodies = || scene.bodies.iter().zip(models).zip(&results.metadata.bodies);
    if results.rows() == 0 {
        return Err(rows::no_rows(file));
    }
    let ties = Ties::new(scene, models)?;
    let of_body = |(number, ((_, model), _))| rows::chosen(file, results, number, model, rows);
    let chosen: Vec<_> = bodies().enumerate().map(of_body).collect::<Result<_, _>>()?;
    let total: usize = chosen.iter().map(Vec::len).sum();
    let mut done = 0;
    let mut checked = Vec::with_capacity(models.len());
    for (number, (((given, model), metadata), rows_of_body)) in bodies().zip(chosen).enumerate() {
        let name = metadata.name.clone();
        let not_checked =
            |why: &str| BodyCheck { name: name.clone(), rows: Vec::new(), not_checked: Some(why.to_owned()) };
        if model.body.flexible() == 0 {
            checked.push(not_checked(RIGID));
            continue;
        }
        if model.meshed.as_ref().is_some_and(|meshed| !meshed.mesh.has_elements()) {
            checked.push(not_checked(&without_elements(given)));
            continue;
        }
        if model.meshed.is_some() && rows_of_body.is_empty() {
            checked.push(not_checked(DEAR));
            continue;
        }
        let full = builder.full(given, |p| progress(CheckProgress::Build(p)))?;
        let Some(full) = full else {
            checked.push(not_checked(&without_elements(given)));
            continue;
        };
        let in_scene = |source: FullError| source.in_file(&given.path);
        let body = full.body().map_err(in_scene)?;
        progress(CheckProgress::Rows { done, total });
        let checker = Checker::new(&full, given, model, &body).map_err(in_scene)?;
        let checker = checker.against(rows::course(results, number));
        let mut of_rows = Vec::with_capacity(rows_of_body.len());
        for (row, why) in rows_of_body {
            let motion = rows::motion(results, number, row).ok_or_else(|| rows::no_rows(file))?;
            let forces = ties.forces(file, (results, scene, models), number, row)?;
            let state = checker.check(&motion, &forces, &StateErrorSettings::default(), true).map_err(in_scene)?;
            of_rows.push(RowCheck { row, why, state });
            done += 1;
            progress(CheckProgress::Rows { done, total });
        }
        checked.push(BodyCheck { name, rows: of_rows, not_checked: None });
    }
    let units = &results.metadata.units;
    Ok(CheckReport {
        title: results.metadata.title.clone(),
        units: [units.length.clone(), units.mass.clone(), units.time.clone()],
        results: file.to_owned(),
        bodies: checked,
        trust: None,
    })
}
