//! `flexframe run`: a scene from its meshes to its results file.
//!
//! Nothing acts between the bodies of a scene: each is a set of equations of its own with steps of its own, and moves as it would
//! alone. They meet at the rows (`row_times`), which are written together.

mod balances;
mod body;
mod body_report;
mod checkpoint;
mod error;
mod estimate;
mod metadata;
mod recorder;
mod report;
mod row_times;
mod settings;
mod turn;
mod watch;
mod words;

use std::path::Path;
use std::time::Instant;

use dynamics::{Initial, Simulation};
use model::{BuildError, BuildProgress, Builder, Model};
use results::{Expected, Results, Resumed, Writer, unfinished};
use scene::{Scene, System};

pub use balances::Balances;
pub(crate) use balances::Monitor;
pub use body::RunBody;
pub use body_report::BodyRunReport;
pub use error::{RunError, RunFailure};
pub use estimate::Estimate;
pub use metadata::metadata;
pub(crate) use metadata::units;
pub use report::{RunReport, SystemReport};
pub use settings::{RunProgress, RunSettings};
pub use watch::{Watch, Watched};

use crate::drawn::stored_shapes;
use crate::files::outputs::outputs_of_scenes;
pub use crate::files::results_path::results_path;
use crate::files::scene_file;
use crate::rows::columns::COLUMNS;
use crate::rows::row::Row;
use body::MovingBody;
use checkpoint::{checkpoint, restored};
use estimate::LARGE;
use metadata::metadata_of_file;
use recorder::Recorder;

/// Runs the bodies of a scene and writes their results to `<folder>/<name of the scene file>.h5`; until the end they are in an
/// unfinished file beside it ([`results::unfinished`]). `progress` hears how far it is, at every phase and every few
/// thousand steps.
///
/// # Errors
/// [`RunError`]. When a step fails, the unfinished file keeps the rows before it.
pub fn run(
    scenes: &[Scene],
    folder: &Path,
    settings: &RunSettings,
    mut progress: impl FnMut(RunProgress),
) -> Result<(Vec<Model>, RunReport), RunError> {
    check(scenes, folder, settings)?;
    let models = build(scenes, &settings.builder, |p| progress(RunProgress::Build(p)))?;
    // Who is to stop may do so here, before there is an unfinished file: the last phase of the build may have been long.
    progress(RunProgress::Built);
    let report = run_models(&bodies(scenes, &models), folder, settings, progress)?;
    Ok((models, report))
}

/// Refuses a run that could not write its files.
fn check(scenes: &[Scene], folder: &Path, settings: &RunSettings) -> Result<(), RunError> {
    let path = results_path(scenes, folder).ok_or(RunError::NoBody)?;
    let outputs = outputs_of_scenes(scenes, &settings.builder, settings.overwrite);
    outputs.spare(&path)?;
    outputs.spare(&unfinished(&path))?;
    std::fs::create_dir_all(folder).map_err(|source| RunError::Folder { folder: folder.to_owned(), source })?;
    Ok(Writer::<Row>::check(&path, settings.overwrite)?)
}

fn build(
    scenes: &[Scene],
    builder: &Builder,
    mut progress: impl FnMut(BuildProgress),
) -> Result<Vec<Model>, BuildError> {
    scenes.iter().map(|scene| builder.build(scene, &mut progress)).collect()
}

/// The bodies of scenes and their models.
pub(crate) fn bodies<'a>(scenes: &'a [Scene], models: &'a [Model]) -> Vec<RunBody<'a>> {
    scenes.iter().zip(models).map(|(scene, model)| RunBody { scene, model }).collect()
}

/// The same of models that are there already.
///
/// # Errors
/// As [`run`].
pub fn run_models(
    bodies: &[RunBody<'_>],
    folder: &Path,
    settings: &RunSettings,
    mut progress: impl FnMut(RunProgress),
) -> Result<RunReport, RunError> {
    let scene = bodies.first().ok_or(RunError::NoBody)?.scene;
    let path = results_path(bodies.iter().map(|body| body.scene), folder).ok_or(RunError::NoBody)?;
    let started = Instant::now();
    let simulations: Vec<Simulation> = bodies.iter().map(start).collect::<Result<_, _>>()?;
    let checkpoint = checkpoint(&simulations, &path)?.len();
    let metadata = metadata_of_file(bodies, &settings.builder).ok_or(RunError::NoBody)?;
    let estimate = Estimate::of_rows(scene, &metadata);
    if estimate.bytes > LARGE && !settings.large {
        return Err(RunError::Large { scene: scene.path.clone(), estimate });
    }
    let estimate = estimate.with_seconds(&simulations, &settings.stop);
    progress(RunProgress::Estimate(estimate));
    let rows = usize::try_from(estimate.rows).unwrap_or(usize::MAX);
    let shapes = if settings.rows_alone { Vec::new() } else { stored_shapes(bodies).map_err(BuildError::from)? };
    let expected = Expected { rows, checkpoint, overwrite: settings.overwrite };
    let writer = Writer::create(&path, &metadata, &shapes, &COLUMNS, expected)?;
    drop(shapes);
    progress(RunProgress::Motion(0.0));
    let initial = initial(bodies);
    let mut recorder = Recorder::new(moving(bodies, &initial, simulations)?, writer, estimate);
    recorder.begin()?;
    recorder.follow(started, settings, progress)
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
    let scenes = scenes_of(&results)?.ok_or_else(|| changed("the list of bodies"))?;
    outputs_of_scenes(&scenes, &settings.builder, settings.overwrite).spare(writer.path())?;
    let models = build(&scenes, &settings.builder, |p| progress(RunProgress::Build(p)))?;
    progress(RunProgress::Built);
    let bodies = bodies(&scenes, &models);
    let estimate = Estimate::of_rows(bodies.first().ok_or(RunError::NoBody)?.scene, &results.metadata);
    let started = Instant::now();
    let mut simulations: Vec<Simulation> = bodies.iter().map(start).collect::<Result<_, _>>()?;
    let now = metadata_of_file(&bodies, &settings.builder).ok_or(RunError::NoBody)?;
    if now.program_version != results.metadata.program_version {
        return Err(changed("the version of flexframe"));
    }
    let are_same = now.bodies.iter().zip(&results.metadata.bodies).all(|(now, then)| now.model == then.model);
    if !are_same {
        return Err(changed("the body"));
    }
    progress(RunProgress::Motion(0.0));
    if let Some(state) = &state {
        simulations =
            restored(simulations, state).map_err(|source| RunError::Restore { part: part.clone(), source })?;
    }
    let initial = initial(&bodies);
    let mut recorder = Recorder::new(moving(&bodies, &initial, simulations)?, writer, estimate);
    match state {
        Some(_) => recorder.take_up(&results)?,
        None => recorder.begin()?,
    }
    recorder.follow(started, settings, progress)
}

/// The scenes of the bodies of a run that is to go on; `None` where one of them is not there.
fn scenes_of(results: &Results) -> Result<Option<Vec<Scene>>, RunError> {
    let metadata = &results.metadata;
    let system = System::parse(&metadata.scene_text, scene_file::to_path(&metadata.scene_file))?;
    let scene_of = |name: &str| system.bodies.iter().find(|scene| body::name(scene) == name);
    Ok(metadata.bodies.iter().map(|body| scene_of(&body.name).cloned()).collect())
}

fn start(RunBody { scene, model }: &RunBody<'_>) -> Result<Simulation, RunError> {
    model.start(scene).map_err(|source| RunError::Setup { scene: scene.path.clone(), source: Box::new(source) })
}

fn initial(bodies: &[RunBody<'_>]) -> Vec<Initial> {
    bodies.iter().map(|RunBody { scene, model }| model.initial(scene)).collect()
}

fn moving<'a>(
    bodies: &[RunBody<'a>],
    initial: &'a [Initial],
    simulations: Vec<Simulation>,
) -> Result<Vec<MovingBody<'a>>, RunError> {
    let bodies = bodies.iter().zip(initial).zip(simulations);
    bodies.map(|((body, initial), simulation)| MovingBody::new(*body, initial, simulation)).collect()
}
