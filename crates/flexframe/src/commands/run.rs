//! `flexframe run`: a scene from its meshes to its results file.
//!
//! Bodies that joints, springs or bushings tie together are an island with steps of its own; so is each body that nothing ties. Islands
//! meet at the rows (`dynamics::Run`), which are written together.

mod accuracy_report;
mod balances;
mod body;
pub(crate) mod body_report;
mod error;
mod estimate;
mod large_choice;
mod metadata;
mod recorder;
mod report;
mod settings;
mod tied_report;
mod turn;
mod watch;
mod words;

use std::path::Path;
use std::time::Instant;

use diagnostic::Failure;
use dynamics::{Initial, Run};
use model::{BuildError, Model};
use results::{Expected, Results, Resumed, Writer, unfinished};
use scene::{Body, Scene, SceneError};

pub use accuracy_report::{AccuracyReport, Round, StoppedBy};
pub use balances::Balances;
pub(crate) use balances::Monitor;
pub use body::RunBody;
pub use body_report::BodyRunReport;
pub use error::{RunError, RunFailure};
pub use estimate::Estimate;
pub use large_choice::LargeChoice;
pub(crate) use large_choice::WORTH;
pub(crate) use metadata::units;
pub use metadata::{metadata, metadata_of_scene};
pub use report::{RunReport, SystemReport, TableInUse};
pub use settings::{RunProgress, RunSettings};
pub use tied_report::{AssembledReport, HeldReport, StepLimitReport, TiedReport};
pub use watch::{Watch, Watched};

use crate::commands::check::checked_rows::{CheckProgress, check_run};
use crate::commands::check::report::CheckReport;
use crate::commands::check::rows::CheckRows;
use crate::drawn::{stored_bytes, stored_shapes};
use crate::files::identity::{contents, identity_of_files};
use crate::files::outputs::outputs_of_scene;
pub use crate::files::results_path::results_path;
use crate::files::scene_file;
use crate::motion::{StartSettings, begin};
use crate::plausible;
use crate::rows::columns::COLUMNS;
use crate::rows::row::Row;
use crate::trust;
use body::FollowedBody;
use estimate::LARGE;
use metadata::metadata_of_file;
use recorder::{Recorder, checkpoint};

/// Runs the bodies of a scene and writes their results to `<folder>/<name of the scene file>.h5`; until the end they are in an
/// unfinished file beside it ([`results::unfinished`]). `progress` hears how far it is, at every phase and every few
/// thousand steps.
///
/// # Errors
/// [`RunError`]. When a step fails, the unfinished file keeps the rows before it.
pub fn run(
    scene: &Scene,
    folder: &Path,
    settings: &RunSettings,
    mut progress: impl FnMut(RunProgress),
) -> Result<(Vec<Model>, RunReport), RunError> {
    check_files(scene, folder, settings)?;
    let models = settings.builder.models(scene, |p| progress(RunProgress::Build(p)))?;
    // Who is to stop may do so here, before there is an unfinished file: the last phase of the build may have been long.
    progress(RunProgress::Built);
    let report = run_models(scene, &models, folder, settings, &mut progress)?;
    let chosen = report.large_choice.as_ref().and_then(|choice| choice.taken(scene, report.steps));
    let Some(chosen) = chosen else { return Ok((models, report)) };
    again(&chosen, (models, report), folder, settings, progress)
}

/// Runs a system once more with the large modes that the check of the first run has found better. The first stands where this cannot be done.
fn again(
    scene: &Scene,
    (models, first): (Vec<Model>, RunReport),
    folder: &Path,
    settings: &RunSettings,
    mut progress: impl FnMut(RunProgress),
) -> Result<(Vec<Model>, RunReport), RunError> {
    let over = RunSettings { overwrite: true, ..settings.clone() };
    let second = settings
        .builder
        .models(scene, |p| progress(RunProgress::Build(p)))
        .map_err(RunError::from)
        .and_then(|models| Ok((run_models(scene, &models, folder, &over, progress)?, models)));
    match second {
        Ok((mut report, models)) => {
            report.times.add_all(&first.times);
            Ok((models, RunReport { large_choice: first.large_choice, large_is_chosen: true, ..report }))
        }
        Err(error) => {
            // What was written of it is of no use: the results of the first are whole.
            std::fs::remove_file(unfinished(&first.results)).ok();
            let mut report = first;
            report.warnings.push(format!("the run with other large modes has failed: {error}"));
            Ok((models, report))
        }
    }
}

/// Checks the worst rows of each body by the full body, as many as cost no more than the reduction did, if the run is to be checked; states
/// how far its answer can be trusted; and puts the results into their place.
fn conclude(
    scene: &Scene,
    models: &[Model],
    settings: &RunSettings,
    (mut report, mut writer): (RunReport, Writer<Row>),
    mut progress: impl FnMut(RunProgress),
) -> Result<RunReport, RunError> {
    report.tables = TableInUse::all(scene);
    report.warnings.extend(plausible::struck_drives(scene));
    let file = report.results.file_name().unwrap_or_default().to_string_lossy().into_owned();
    if !settings.rows_alone {
        let started = Instant::now();
        let results = writer.results()?;
        let checked = settings.check.then(|| {
            checked(&report.results, &results, (scene, models), settings, |p| progress(RunProgress::Check(p)))
        });
        if let Some(Ok(checked)) = &checked {
            let worth = settings.accuracy.map_or(large_choice::WORTH, large_choice::worth);
            match LargeChoice::better(&results, (scene, models), &settings.builder, checked, worth) {
                Ok(better) => report.large_choice = better,
                Err(error) => report.warnings.push(format!("other large modes could not be checked: {error}")),
            }
            report.warnings.extend(LargeChoice::not_tried((scene, models), checked));
        }
        if settings.check {
            report.times.add("check", started.elapsed());
        }
        let started = Instant::now();
        // The run is done whatever comes of it.
        let not_checked = match checked {
            None => "the run was made without the check",
            Some(Ok(checked)) => {
                report.check = Some(checked);
                ""
            }
            Some(Err(error)) => {
                report.warnings.push(format!("it could not be checked by the full nonlinear body: {error}"));
                "the check by the full body could not be made"
            }
        };
        let check = report.check.as_ref().ok_or(not_checked);
        let cure = report.large_choice.as_ref().map(LargeChoice::cure);
        let card = trust::of_run((scene, models), &results, &report.bodies, check, cure.as_deref(), &file);
        writer.trust(card.lines.clone());
        report.trust = Some(card);
        report.times.add("trust", started.elapsed());
    }
    let started = Instant::now();
    writer.warn(report.warnings.clone());
    writer.finish()?;
    report.times.add("writing", started.elapsed());
    Ok(report)
}

/// The check of a run: of the worst rows that cost little, or, where an accuracy is asked for, of all of them, and of rows on the way if none of
/// these tells against it.
fn checked(
    file: &Path,
    results: &Results,
    (scene, models): (&Scene, &[Model]),
    settings: &RunSettings,
    mut progress: impl FnMut(CheckProgress),
) -> Result<CheckReport, Failure> {
    let mut of = |rows: &CheckRows| check_run(file, results, scene, models, &settings.builder, rows, &mut progress);
    let Some(accuracy) = settings.accuracy else { return of(&CheckRows::Cheap) };
    let mut found = of(&CheckRows::Worst)?;
    if found.largest_error() < accuracy {
        found.add(of(&CheckRows::OnTheWay)?);
    }
    Ok(found)
}

/// Refuses a run that could not write its files.
pub(crate) fn check_files(scene: &Scene, folder: &Path, settings: &RunSettings) -> Result<(), RunError> {
    let path = results_path(scene, folder);
    let outputs = outputs_of_scene(scene, &settings.builder, settings.overwrite);
    outputs.spare(&path)?;
    outputs.spare(&unfinished(&path))?;
    std::fs::create_dir_all(folder).map_err(|source| RunError::Folder { folder: folder.to_owned(), source })?;
    Ok(Writer::<Row>::check(&path, settings.overwrite)?)
}

/// The bodies of scenes and their models.
pub(crate) fn bodies<'a>(scenes: &'a [Body], models: &'a [Model]) -> Vec<RunBody<'a>> {
    scenes.iter().zip(models).map(|(body, model)| RunBody { body, model }).collect()
}

/// The same of models that are there already, one for each body.
///
/// # Errors
/// As [`run`].
pub fn run_models(
    scene: &Scene,
    models: &[Model],
    folder: &Path,
    settings: &RunSettings,
    mut progress: impl FnMut(RunProgress),
) -> Result<RunReport, RunError> {
    let bodies = bodies(&scene.bodies, models);
    let path = results_path(scene, folder);
    let started = Instant::now();
    let initial = initial(&bodies);
    let run = begin_run(scene, models)?;
    let identity = identity(scene, settings);
    let checkpoint = checkpoint(identity, &run, &path)?.len();
    let metadata = metadata_of_file(scene, &bodies, &settings.builder);
    let of_shapes = if settings.rows_alone { 0 } else { stored_bytes(&bodies) };
    let estimate = Estimate::of_rows(scene, &metadata, of_shapes);
    if estimate.bytes > LARGE && !settings.large {
        return Err(RunError::Large { scene: scene.path.clone(), estimate });
    }
    let estimate = estimate.with_seconds(&run, &settings.stop);
    progress(RunProgress::Estimate(estimate));
    let rows = usize::try_from(estimate.rows).unwrap_or(usize::MAX);
    let shapes = if settings.rows_alone { Vec::new() } else { stored_shapes(&bodies).map_err(BuildError::from)? };
    let expected = Expected { rows, checkpoint, overwrite: settings.overwrite };
    let writer = Writer::create(&path, &metadata, &shapes, &COLUMNS, expected)?;
    drop(shapes);
    progress(RunProgress::Motion(0.0));
    let followed = followed(&bodies, &initial)?;
    let mut recorder = Recorder::new(run, followed, writer, estimate, identity);
    recorder.begin()?;
    let followed = recorder.follow(scene, started, settings, &mut progress)?;
    conclude(scene, models, settings, followed, progress)
}

/// Goes on with a run that was cut off, from the last checkpoint in its unfinished file (which may be given by the name
/// of the results file, too): the finished file is the same as if the run had not been cut off, bit for bit. The scene
/// is that of the file, read once more: a run needs its loads; its meshes and tables are looked for where they were.
///
/// # Errors
/// [`RunError`].
pub fn resume(
    file: &Path,
    settings: &RunSettings,
    mut progress: impl FnMut(RunProgress),
) -> Result<RunReport, RunError> {
    let Resumed { writer, results, checkpoint: state } = Writer::resume(file, &COLUMNS, settings.overwrite)?;
    let part = writer.unfinished().to_path_buf();
    let changed = |what| RunError::Changed { part: part.clone(), what };
    let scene = system_of(&results)?.ok_or_else(|| changed("the list of bodies"))?;
    outputs_of_scene(&scene, &settings.builder, settings.overwrite).spare(writer.path())?;
    let models = settings.builder.models(&scene, |p| progress(RunProgress::Build(p)))?;
    progress(RunProgress::Built);
    let bodies = bodies(&scene.bodies, &models);
    let of_shapes = if settings.rows_alone { 0 } else { stored_bytes(&bodies) };
    let estimate = Estimate::of_rows(&scene, &results.metadata, of_shapes);
    let started = Instant::now();
    let now = metadata_of_file(&scene, &bodies, &settings.builder);
    if now.program_version != results.metadata.program_version {
        return Err(changed("the version of flexframe"));
    }
    let are_same = now.bodies.iter().zip(&results.metadata.bodies).all(|(now, then)| now.model == then.model);
    if !are_same {
        return Err(changed("the body"));
    }
    if now.joints != results.metadata.joints {
        return Err(changed("a joint"));
    }
    let initial = initial(&bodies);
    let mut run = begin_run(&scene, &models)?;
    progress(RunProgress::Motion(0.0));
    let identity = identity(&scene, settings);
    if let Some(state) = state.as_deref() {
        let (then, state) = state.split_first().ok_or_else(|| changed("the motion at the checkpoint"))?;
        run = run.restored(state).map_err(|source| RunError::Restore { part: part.clone(), source })?;
        // A changed load is known by its name before.
        if *then != identity {
            return Err(changed("a file that the run reads"));
        }
    }
    let mut recorder = Recorder::new(run, followed(&bodies, &initial)?, writer, estimate, identity);
    match state {
        Some(_) => recorder.take_up(&results)?,
        None => recorder.begin()?,
    }
    let (mut report, writer) = recorder.follow(&scene, started, settings, &mut progress)?;
    if scene.accuracy.is_some() {
        let words =
            "the search for the accuracy was cut off, and this run is as far as it came: run the scene again to go on";
        report.warnings.push(words.to_owned());
    }
    conclude(&scene, &models, settings, (report, writer), progress)
}

/// The number of the files that a run reads; none for the rows of a sweep, which do not go on.
fn identity(scene: &Scene, settings: &RunSettings) -> u64 {
    if settings.rows_alone { 0 } else { identity_of_files(scene, |body| contents(&body.source)) }
}

/// The system of a run, with the bodies that the run has; `None` where one of them is not there.
pub(crate) fn system_of(results: &Results) -> Result<Option<Scene>, SceneError> {
    let metadata = &results.metadata;
    let scene = Scene::parse(&metadata.scene_text, scene_file::to_path(&metadata.scene_file))?;
    let are_all = scene.bodies.len() == metadata.bodies.len()
        && scene.bodies.iter().zip(&metadata.bodies).all(|(given, body)| body::name(given) == body.name);
    if are_all || scene.has_ties() {
        return Ok(are_all.then_some(scene));
    }
    let scene_of = |name: &str| scene.bodies.iter().find(|given| body::name(given) == name);
    let bodies: Option<Vec<Body>> = metadata.bodies.iter().map(|body| scene_of(&body.name).cloned()).collect();
    Ok(bodies.map(|bodies| Scene { bodies, ..scene.clone() }))
}

/// The run of a system from its start.
fn begin_run(scene: &Scene, models: &[Model]) -> Result<Run, RunError> {
    let models: Vec<&Model> = models.iter().collect();
    let beginning = StartSettings::of(scene, &models);
    Ok(begin(scene, &models, &beginning).map_err(|error| error.at_key(scene))?)
}

fn followed<'a>(bodies: &[RunBody<'a>], initial: &'a [Initial]) -> Result<Vec<FollowedBody<'a>>, RunError> {
    bodies
        .iter()
        .zip(initial)
        .enumerate()
        .map(|(number, (of, initial))| FollowedBody::new(*of, number, initial))
        .collect()
}

fn initial(bodies: &[RunBody<'_>]) -> Vec<Initial> {
    bodies.iter().map(|RunBody { body, model }| model.initial(body)).collect()
}
