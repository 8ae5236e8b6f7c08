//! Rows of a run whose models are there, checked.

use std::path::Path;

use modal::SolveStats;
use model::{BuildProgress, Builder, Checker, Model};
use nonlinear::StateErrorSettings;
use results::Results;
use scene::System;

use super::error::CheckError;
use super::joints;
use super::report::{BodyCheck, CheckReport, RIGID, RowCheck};
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

/// Most unknowns of a body that a run checks unasked.
const CHEAP: usize = 30_000;

/// True if the check of a row costs no more than the body did, and next to no memory.
pub(crate) fn is_cheap(stats: &SolveStats) -> bool {
    stats.unknowns <= CHEAP
}

/// Checks the rows of a run whose models are there.
///
/// # Errors
/// [`CheckError`].
pub fn check_run(
    file: &Path,
    results: &Results,
    system: &System,
    models: &[Model],
    builder: &Builder,
    rows: &CheckRows,
    mut progress: impl FnMut(CheckProgress),
) -> Result<CheckReport, CheckError> {
    let bodies = || system.bodies.iter().zip(models).zip(&results.metadata.bodies);
    if results.rows() == 0 {
        return Err(CheckError::NoRows { file: file.to_owned() });
    }
    let of_body = |(number, ((_, model), _))| rows::chosen(file, results, number, model, rows);
    let chosen: Vec<_> = bodies().enumerate().map(of_body).collect::<Result<_, _>>()?;
    let total: usize = chosen.iter().map(Vec::len).sum();
    let mut done = 0;
    let mut checked = Vec::with_capacity(models.len());
    for (number, (((scene, model), metadata), rows)) in bodies().zip(chosen).enumerate() {
        let name = metadata.name.clone();
        let not_checked =
            |why: &str| BodyCheck { name: name.clone(), rows: Vec::new(), not_checked: Some(why.to_owned()) };
        if let Some(why) = joints::unknown(system, number) {
            checked.push(not_checked(why));
            continue;
        }
        if model.body.flexible() == 0 {
            checked.push(not_checked(RIGID));
            continue;
        }
        let full = builder.full(scene, |p| progress(CheckProgress::Build(p)))?;
        let Some(full) = full else {
            checked.push(not_checked("it has no elements: it is made of matrices"));
            continue;
        };
        let in_scene = |source| CheckError::Full { scene: scene.path.clone(), source: Box::new(source) };
        let body = full.body().map_err(in_scene)?;
        progress(CheckProgress::Rows { done, total });
        let checker = Checker::new(&full, scene, model, &body).map_err(in_scene)?;
        let mut of_rows = Vec::with_capacity(rows.len());
        for (row, why) in rows {
            let motion = rows::motion(results, number, row).ok_or(CheckError::NoRows { file: file.to_owned() })?;
            let forces = joints::forces(results, system, models, number, row);
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
    })
}
