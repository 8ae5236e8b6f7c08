//! `flexframe check`: rows of a run against the full nonlinear body.
//!
//! The model is built again from the scene in the results file and from the mesh, which has to be there as it was.

mod error;
mod joints;
mod report;
mod rows;

use std::path::Path;

use modal::SolveStats;
use model::{BuildProgress, Builder, Checker, Model};
use nonlinear::StateErrorSettings;
use results::Results;
use scene::System;

pub use error::CheckError;
pub use report::{BodyCheck, CheckReport, RowCheck};

use crate::commands::run::{RunBody, bodies, metadata, system_of};
use crate::rows::columns::COLUMNS;

/// Which rows are checked.
#[derive(Debug, Clone, PartialEq)]
pub enum CheckRows {
    /// The rows at which a model is most likely to be wrong: the largest strain energy, the largest stress, the largest spin, the last.
    Worst,
    /// Of these the first alone.
    First,
    /// Rows by their numbers, from 0.
    Given(Vec<usize>),
}

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

/// Most unknowns of a body whose check costs no more than its reduction did.
const CHEAP: usize = 60_000;

/// True if the check of a row costs no more than the modes of the body did: not where these needed no factor, or another program found
/// them.
pub(crate) fn is_cheap(stats: &SolveStats) -> bool {
    stats.cycles == 0 && stats.engine.is_none() && stats.unknowns <= CHEAP
}

/// Checks a results file, finished or not.
///
/// # Errors
/// [`CheckError`].
pub fn check(
    file: &Path,
    builder: &Builder,
    rows: &CheckRows,
    mut progress: impl FnMut(CheckProgress),
) -> Result<CheckReport, CheckError> {
    let results = Results::open(file, &COLUMNS)?;
    let changed = |what| CheckError::Changed { file: file.to_owned(), what };
    let system = system_of(&results)?.ok_or_else(|| changed("the list of bodies"))?;
    let build = |scene| builder.build(scene, |p| progress(CheckProgress::Build(p)));
    let models: Vec<Model> = system.bodies.iter().map(build).collect::<Result<_, _>>()?;
    let of = bodies(&system.bodies, &models);
    let now = metadata(&of).ok_or_else(|| changed("the list of bodies"))?;
    for (now, then) in now.bodies.iter().zip(&results.metadata.bodies) {
        let mut then = then.model.clone();
        then.mesh = None;
        if now.model != then {
            return Err(changed("the body"));
        }
    }
    check_run(file, &results, &system, &models, builder, rows, progress)
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
    let of = bodies(&system.bodies, models);
    if results.rows() == 0 {
        return Err(CheckError::NoRows { file: file.to_owned() });
    }
    let mut chosen = Vec::with_capacity(of.len());
    for (number, RunBody { model, .. }) in of.iter().enumerate() {
        chosen.push(rows::chosen(file, results, number, model, rows)?);
    }
    let total: usize = chosen.iter().map(Vec::len).sum();
    let mut done = 0;
    let mut checked = Vec::with_capacity(of.len());
    for (number, (RunBody { scene, model }, rows)) in of.iter().zip(chosen).enumerate() {
        let name = of[number].name().to_owned();
        let not_checked =
            |why: &str| BodyCheck { name: name.clone(), rows: Vec::new(), not_checked: Some(why.to_owned()) };
        if let Some(why) = joints::unknown(system, number) {
            checked.push(not_checked(why));
            continue;
        }
        if model.body.flexible() == 0 {
            checked.push(not_checked(report::RIGID));
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
