//! `flexframe run`: a scene from its mesh to its results file.

mod balances;
mod bodies;
mod error;
mod estimate;
mod recorder;
mod report;
mod settings;
mod turn;
mod watch;

use std::path::Path;
use std::time::Instant;

use dynamics::{DrivenMotion, Simulation};
use model::{BuildError, Builder, Model};
use results::{BodyProperties, Expected, Metadata, Results, Resumed, Units, Writer, unfinished};
use scene::{Scene, SceneError, StepControl};

pub use balances::Balances;
pub(crate) use balances::Monitor;
pub use bodies::BodyRuns;
pub use error::{RunError, RunFailure};
pub use estimate::Estimate;
pub use report::RunReport;
pub use settings::{RunProgress, RunSettings};
pub use watch::{Watch, Watched};

use crate::drawn::{mesh_properties, stored_shapes};
use crate::files::outputs::outputs_of_scene;
pub use crate::files::results_path::results_path;
use crate::files::scene_file;
use crate::report::BodyReport;
use crate::rows::columns::{COLUMNS, part};
use crate::rows::effects;
use crate::rows::row::Row;
use estimate::LARGE;
use recorder::Recorder;

/// Runs a scene and writes its results to `<folder>/<name of the scene file>.h5`; until the end they are in an
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
) -> Result<(Model, RunReport), RunError> {
    check(scene, folder, settings)?;
    let model = settings.builder.build(scene, |p| progress(RunProgress::Build(p)))?;
    // Who is to stop may do so here, before there is an unfinished file: the last phase of the build may have been long.
    progress(RunProgress::Built);
    let report = run_model(scene, &model, folder, settings, progress)?;
    Ok((model, report))
}

/// Runs all bodies of a scene, each to a results file of its own: nothing acts between them, so each moves as it would alone, in
/// steps of its own. All files are checked before the first run.
///
/// # Errors
/// [`RunError`]. Files of the bodies before the one that fails stay.
pub fn run_bodies(
    scenes: &[Scene],
    folder: &Path,
    settings: &RunSettings,
    mut progress: impl FnMut(RunProgress),
) -> Result<BodyRuns, RunError> {
    scenes.iter().try_for_each(|scene| check(scene, folder, settings))?;
    let of_body = |scene: &Scene| Ok((scene.name.clone(), run(scene, folder, settings, &mut progress)?.1));
    Ok(BodyRuns(scenes.iter().map(of_body).collect::<Result<_, RunError>>()?))
}

/// Refuses a run that could not write its files.
fn check(scene: &Scene, folder: &Path, settings: &RunSettings) -> Result<(), RunError> {
    let path = results_path(scene, folder);
    let outputs = outputs_of_scene(scene, &settings.builder, settings.overwrite);
    outputs.spare(&path)?;
    outputs.spare(&unfinished(&path))?;
    std::fs::create_dir_all(folder).map_err(|source| RunError::Folder { folder: folder.to_owned(), source })?;
    Ok(Writer::<Row>::check(&path, settings.overwrite)?)
}

/// The same of a model that is there already.
///
/// # Errors
/// As [`run`].
pub fn run_model(
    scene: &Scene,
    model: &Model,
    folder: &Path,
    settings: &RunSettings,
    mut progress: impl FnMut(RunProgress),
) -> Result<RunReport, RunError> {
    let path = results_path(scene, folder);
    let started = Instant::now();
    let mut simulation = start(scene, model)?;
    let checkpoint = simulation.checkpoint().map_err(|source| RunError::Restore { part: path.clone(), source })?.len();
    let metadata = metadata_of_file(scene, model, &settings.builder);
    let estimate = Estimate::of_rows(scene, &metadata);
    if estimate.bytes > LARGE && !settings.large {
        return Err(RunError::Large { scene: scene.path.clone(), estimate });
    }
    let estimate = estimate.with_seconds(&simulation, &settings.stop);
    progress(RunProgress::Estimate(estimate));
    let rows = usize::try_from(estimate.rows).unwrap_or(usize::MAX);
    let shapes = if settings.rows_alone { None } else { stored_shapes(model).map_err(BuildError::from)? };
    let expected = Expected { rows, checkpoint, overwrite: settings.overwrite };
    let writer = Writer::create(&path, &metadata, shapes.as_ref(), &COLUMNS, expected)?;
    drop(shapes);
    progress(RunProgress::Motion(0.0));
    let initial = model.initial(scene);
    let mut recorder = Recorder::new(scene, model, &initial, writer, estimate)?;
    recorder.begin(&mut simulation)?;
    recorder.follow(simulation, started, settings, progress)
}

/// Goes on with a run that was cut off, from the last checkpoint in its unfinished file (which may be given by the name
/// of the results file, too): the finished file is the same as if the run had not been cut off, bit for bit. The scene
/// is that of the file, read once more: a run needs its loads; its mesh and tables are looked for where they were.
///
/// # Errors
/// [`RunError`].
pub fn resume(
    file: &Path,
    settings: &RunSettings,
    mut progress: impl FnMut(RunProgress),
) -> Result<(Scene, Model, RunReport), RunError> {
    let Resumed { writer, results, checkpoint } = Writer::resume(file, &COLUMNS, settings.overwrite)?;
    let part = writer.unfinished().to_path_buf();
    let scene = scene_of(&results)?;
    outputs_of_scene(&scene, &settings.builder, settings.overwrite).spare(writer.path())?;
    let estimate = Estimate::of_rows(&scene, &results.metadata);
    let model = settings.builder.build(&scene, |p| progress(RunProgress::Build(p)))?;
    progress(RunProgress::Built);
    let started = Instant::now();
    let mut simulation = start(&scene, &model)?;
    let changed = |what| RunError::Changed { part: part.clone(), what };
    let now = metadata_of_file(&scene, &model, &settings.builder);
    if now.program_version != results.metadata.program_version {
        return Err(changed("the version of flexframe"));
    }
    if now.body != results.metadata.body {
        return Err(changed("the body"));
    }

    progress(RunProgress::Motion(0.0));
    let initial = model.initial(&scene);
    let report = match checkpoint {
        Some(checkpoint) => {
            simulation =
                simulation.restored(&checkpoint).map_err(|source| RunError::Restore { part: part.clone(), source })?;
            let mut recorder = Recorder::new(&scene, &model, &initial, writer, estimate)?;
            recorder.take_up(&mut simulation, &results)?;
            recorder.follow(simulation, started, settings, progress)?
        }
        None => {
            let mut recorder = Recorder::new(&scene, &model, &initial, writer, estimate)?;
            recorder.begin(&mut simulation)?;
            recorder.follow(simulation, started, settings, progress)?
        }
    };
    Ok((scene, model, report))
}

/// The scene of a run that is to go on.
fn scene_of(results: &Results) -> Result<Scene, SceneError> {
    let Metadata { scene_text, scene_file, .. } = &results.metadata;
    Scene::parse(scene_text, scene_file::to_path(scene_file))
}

fn start(scene: &Scene, model: &Model) -> Result<Simulation, RunError> {
    model.start(scene).map_err(|source| RunError::Setup { scene: scene.path.clone(), source: Box::new(source) })
}

/// The metadata in the results file of a run.
fn metadata_of_file(scene: &Scene, model: &Model, builder: &Builder) -> Metadata {
    let metadata = metadata(scene, model);
    Metadata {
        input_files: builder.files(scene).iter().map(|file| scene_file::to_text(file)).collect(),
        body: BodyProperties { mesh: mesh_properties(scene, model), ..metadata.body },
        ..metadata
    }
}

/// The metadata of a run without what only a file has: the files that it read, and the size of its mesh.
pub fn metadata(scene: &Scene, model: &Model) -> Metadata {
    let body = BodyReport::new(model);
    let method = scene.time.method;
    let (step, tolerance) = match scene.time.control {
        StepControl::Fixed(step) => (Some(step), None),
        StepControl::Tolerance(tolerance) => (None, Some(tolerance)),
    };
    Metadata {
        title: scene.title.clone(),
        units: units(scene),
        formulation: method.formulation.to_owned(),
        scheme: method.scheme.to_owned(),
        step,
        tolerance,
        program_version: env!("CARGO_PKG_VERSION").to_owned(),
        end: scene.time.end,
        scene_text: scene.source.clone(),
        scene_file: scene_file::to_text(&scene.path),
        input_files: Vec::new(),
        body: BodyProperties {
            mass: body.mass,
            center_of_mass: body.center_of_mass,
            inertia: body.inertia,
            origin: model.body.origin.into(),
            static_shapes: model.static_shapes(),
            frequencies: body.natural_frequencies,
            damping_ratios: body.damping_ratios,
            rotation_axes: model.body.motion.rotations().iter().map(|axis| (*axis).into()).collect(),
            translation_axes: model.body.motion.translations().iter().map(|axis| (*axis).into()).collect(),
            mesh: None,
        },
        point_names: model.points.iter().map(|(name, _)| name.clone()).collect(),
        point_positions: model.points.iter().map(|(_, p)| (model.body.origin + p.position_body()).into()).collect(),
        parts: parts(scene, model).map(str::to_owned).collect(),
        support_names: model.supports.as_ref().map_or(Vec::new(), |supports| supports.names().to_vec()),
        effects: effects::described(scene, model),
        refusal: model.refusal.map(|refusal| refusal.to_string()),
        warnings: Vec::new(),
    }
}

/// The labels of a scene's units.
pub(crate) fn units(scene: &Scene) -> Units {
    let scene::Units { length, mass, time } = scene.units.clone();
    Units { length, mass, time }
}

/// Parts of a run whose file has further columns. In the formulation of the paper there are no reactions.
fn parts(scene: &Scene, model: &Model) -> impl Iterator<Item = &'static str> {
    let motion = &model.body.motion;
    let drive = model.physics.drive.as_ref().map(|drive| drive.motion);
    let turns = matches!(drive, Some(DrivenMotion::Turn { .. }));
    let slides = matches!(drive, Some(DrivenMotion::Slide { .. }));
    let is_held = !motion.is_free() && scene.time.method.abilities.reactions;
    [
        (part::CONSTRAINT, true),
        (part::HINGE, turns || motion.rotations().len() == 1),
        (part::SLIDER, slides || motion.translations().len() == 1),
        (part::DRIVE, drive.is_some()),
        (part::DRIVEN_HINGE, turns),
        (part::DRIVEN_SLIDER, slides),
    ]
    .into_iter()
    .filter_map(move |(part, has)| (is_held && has).then_some(part))
    .chain(model.supports.as_ref().map(|_| part::SUPPORTS))
    .chain(scene.output.stress.then_some(part::STRESS))
}
