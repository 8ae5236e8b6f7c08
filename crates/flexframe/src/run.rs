//! `flexframe run`: a scene from its mesh to its results file.

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use advice::{Refusal, Review, StepEstimate};
use frames_rk4::{CheckpointError, DrivenMotion, Initial, Observation, Reached, Simulation, StepError};
use nalgebra::Vector3;
use results::{BodyProperties, Expected, FileError, Metadata, Results, Resumed, Units, Writer};
use rigid_kin::Attitude;
use scene::{BuildError, BuildProgress, Model, Rows, Scene, SceneError, StartError, StepControl};
use serde::Serialize;

use crate::columns::{COLUMNS, part};
use crate::effects;
use crate::json;
use crate::modes::frequency_unit;
use crate::report::{BodyReport, MeshReport, Times, quantity};
use crate::scene_file;

/// A run that could not be done.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The scene cannot be built.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The motion cannot start.
    #[error("{scene}: {source}")]
    Setup {
        /// The scene file.
        scene: PathBuf,
        /// Why.
        source: Box<StartError>,
    },
    /// A step failed. The states before it are in the unfinished file.
    #[error("{source} (the states before it are in {results})", results = results.display())]
    Step {
        /// The unfinished file.
        results: PathBuf,
        /// Why.
        source: StepError,
    },
    /// The motion has come where the model is known to be wrong. The states before it are in the unfinished file.
    #[error("at time {time:.6}: {refusal} (the states up to there are in {})", results.display())]
    Refused {
        /// The unfinished file.
        results: PathBuf,
        /// When it was so for the first time.
        time: f64,
        /// Why.
        refusal: Refusal,
    },
    /// The results file cannot be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// The scene cannot be run to compare other runs with.
    #[error("{}: the scene itself does not run, so that there is nothing to verify against: {failure}", scene.display())]
    Verify {
        /// The scene file.
        scene: PathBuf,
        /// Why.
        failure: Box<RunFailure>,
    },
    /// The run was asked to stop. The states up to there are in the unfinished file.
    #[error("stopped at time {time}; go on with: flexframe resume {}", part.display())]
    Stopped {
        /// The unfinished file.
        part: PathBuf,
        /// The time that was reached.
        time: f64,
    },
    /// The scene in an unfinished file is invalid.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The checkpoint of an unfinished file is that of another scene, or damaged.
    #[error("{}: {source}", part.display())]
    Restore {
        /// The unfinished file.
        part: PathBuf,
        /// Why.
        source: CheckpointError,
    },
    /// What is computed now is not what was computed then, to the last bit.
    #[error(
        "{}: {what} is no longer what it was when the run began (a changed mesh or table, another version of flexframe, or another machine); a run is continued only if it stays the same bit for bit: run the scene again with --overwrite",
        part.display()
    )]
    Changed {
        /// The unfinished file.
        part: PathBuf,
        /// What has changed.
        what: &'static str,
    },
    /// The output folder cannot be made.
    #[error("{}: cannot make the output folder: {source}", folder.display())]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// Why.
        source: std::io::Error,
    },
}

/// Why a run did not come to its end.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RunFailure {
    /// It could not start.
    #[error(transparent)]
    Start(#[from] StartError),
    /// A step failed.
    #[error(transparent)]
    Step(#[from] StepError),
    /// It was stopped when the time that it may take was used up.
    #[error(
        "stopped at {:.2} % of the motion, when its patience of {patience} s was used up (allow more with --patience)",
        100.0 * reached
    )]
    OutOfPatience {
        /// Time of computing that it was allowed, seconds.
        patience: f64,
        /// Part of the motion that it came to, 0 to 1.
        reached: f64,
    },
}

/// How far a run has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RunProgress {
    /// The model is being built.
    Build(BuildProgress),
    /// Part of the time that has been passed, 0 to 1.
    Motion(f64),
}

/// What `flexframe run` says at its end.
#[derive(Debug, Clone, Serialize)]
pub struct RunReport {
    /// Title of the scene.
    pub title: String,
    /// Labels of length, mass and time.
    pub units: [String; 3],
    /// The results file.
    #[serde(serialize_with = "json::path")]
    pub results: PathBuf,
    /// Rows in it.
    pub rows: u64,
    /// Formulation.
    pub formulation: String,
    /// Scheme.
    pub scheme: String,
    /// Tolerance, under step control.
    pub tolerance: Option<f64>,
    /// Steps taken.
    pub steps: u64,
    /// Steps that step control tried in vain.
    pub rejected_steps: u64,
    /// Lengths of the shortest and the longest step.
    #[serde(serialize_with = "json::numbers")]
    pub step_lengths: [f64; 2],
    /// Evaluations of the rates.
    pub evaluations: u64,
    /// Steps per second of computing, writing included.
    #[serde(serialize_with = "json::number")]
    pub steps_per_second: f64,
    /// The finite-element model.
    pub mesh: Option<MeshReport>,
    /// Mass properties and modes.
    pub body: BodyReport,
    /// Angle between first and last attitude, rad (0 to π).
    pub turned: f64,
    /// Displacement of the centre of mass, global.
    pub moved: [f64; 3],
    /// Largest strain energy among the rows.
    #[serde(serialize_with = "json::number")]
    pub peak_strain_energy: f64,
    /// Kinetic plus strain energy of the last row.
    #[serde(serialize_with = "json::number")]
    pub final_energy: f64,
    /// How far the balances are from closed.
    pub balances: Balances,
    /// Whether the balance of energy is open though the motion is right: modes faster than the steps follow themselves
    /// exactly, but the work on them and their dissipation are summed by the stages.
    pub right_unsummed: bool,
    /// The effects of this body and whether each was computed; none of the paper's formulation, which has its own.
    pub effects: Vec<(&'static str, bool)>,
    /// Assumptions that did not hold.
    pub warnings: Vec<String>,
    /// Where the time went, seconds.
    pub times: Times,
}

/// Largest changes, over the rows, of what should be constants of the motion, relative to the largest value of the
/// quantity itself; of the energy, or to the sum of |work| + |dissipation| of all steps, if that is more.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub struct Balances {
    /// Energy − work of the loads + dissipation.
    #[serde(serialize_with = "json::number")]
    pub energy: f64,
    /// Linear momentum less the impulse of the loads.
    #[serde(serialize_with = "json::number")]
    pub linear_momentum: f64,
    /// Angular momentum about the centre of mass less the angular impulse of the loads.
    #[serde(serialize_with = "json::number")]
    pub angular_momentum: f64,
}

/// How a run treats files, and how it is stopped.
#[derive(Debug, Clone, Default)]
pub struct RunSettings {
    /// Throws an unfinished run away that is in the way.
    pub overwrite: bool,
    /// Set from elsewhere, stops the run at its next row, or before where that is some thousand steps away.
    pub stop: Arc<AtomicBool>,
}

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
    std::fs::create_dir_all(folder).map_err(|source| RunError::Folder { folder: folder.to_owned(), source })?;
    let path = results_path(scene, folder);
    Writer::<Observation>::check(&path, settings.overwrite)?;
    let model = Model::build(scene, |p| progress(RunProgress::Build(p)))?;

    let started = Instant::now();
    let mut simulation = start(scene, &model)?;
    let checkpoint = simulation.checkpoint().map_err(|source| RunError::Restore { part: path.clone(), source })?.len();
    let expected = Expected { rows: expected_rows(scene), checkpoint, overwrite: settings.overwrite };
    let writer = Writer::create(&path, &metadata(scene, &model), &COLUMNS, expected)?;
    progress(RunProgress::Motion(0.0));
    let initial = model.initial(scene);
    let mut recorder = Recorder::new(scene, &model, &initial, writer)?;
    recorder.begin(&mut simulation)?;
    let report = recorder.follow(simulation, started, settings, progress)?;
    Ok((model, report))
}

/// Goes on with a run that was cut off, from the last checkpoint in its unfinished file (which may be given by the name
/// of the results file, too): the finished file is the same as if the run had not been cut off, bit for bit. The scene
/// is that of the file; its mesh and tables are looked for where they were.
///
/// # Errors
/// [`RunError`].
pub fn resume(
    file: &Path,
    settings: &RunSettings,
    mut progress: impl FnMut(RunProgress),
) -> Result<(Scene, Model, RunReport), RunError> {
    let Resumed { writer, results, checkpoint } = Writer::resume(file, &COLUMNS)?;
    let part = writer.unfinished().to_path_buf();
    let scene = Scene::parse(&results.metadata.scene_text, scene_file::to_path(&results.metadata.scene_file))?;
    let model = Model::build(&scene, |p| progress(RunProgress::Build(p)))?;
    let started = Instant::now();
    let mut simulation = start(&scene, &model)?;
    let changed = |what| RunError::Changed { part: part.clone(), what };
    let now = metadata(&scene, &model);
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
            let mut recorder = Recorder::new(&scene, &model, &initial, writer)?;
            recorder.take_up(&mut simulation, &results)?;
            recorder.follow(simulation, started, settings, progress)?
        }
        None => {
            let mut recorder = Recorder::new(&scene, &model, &initial, writer)?;
            recorder.begin(&mut simulation)?;
            recorder.follow(simulation, started, settings, progress)?
        }
    };
    Ok((scene, model, report))
}

fn start(scene: &Scene, model: &Model) -> Result<Simulation, RunError> {
    model.start(scene).map_err(|source| RunError::Setup { scene: scene.path.clone(), source: Box::new(source) })
}

/// Rows that a run will have, but for corners of loads between them; 0 where its steps are not known.
fn expected_rows(scene: &Scene) -> usize {
    let spacing = match (scene.output.rows, scene.time.control) {
        (Rows::Interval(interval), _) => interval,
        (Rows::EverySteps(steps), StepControl::Fixed(step)) => steps as f64 * step,
        (Rows::EverySteps(_), StepControl::Tolerance(_)) => return 0,
    };
    ((scene.time.end / spacing * (1.0 - 1e-12)).ceil() as usize).saturating_add(1)
}

/// Energy balance from which on a run says that it is open.
const OPEN: f64 = 1e-2;

/// Estimated error from which on a run says that its steps are too long.
const WRONG: f64 = 1e-2;
/// Largest step times ω_max in which the stages see the work on the modes and their dissipation as they are.
const RESOLVED: f64 = 0.5;

fn open_balance(open: f64, flexible: usize) -> String {
    let (work, cure) = match flexible {
        0 => ("the work of the loads", "shorter steps"),
        _ => ("the work on modes that are faster than the step", "shorter steps, or fewer modes,"),
    };
    format!(
        "the energy balance is open by {open:.1e} of the energy that there was or that came and went: {work} is summed \
         too coarsely, or the motion itself is; take {cure} until it does not matter to the answer"
    )
}

fn long_steps(estimate: &StepEstimate, share: f64) -> String {
    format!("{} Take shorter steps, or `tolerance` instead of `step`", estimate.in_words(share))
}

/// Steps between two reports of progress, where no row comes first.
const STEPS_PER_REPORT: u64 = 4096;

/// The results file of a scene in a folder.
pub fn results_path(scene: &Scene, folder: &Path) -> PathBuf {
    let mut name = scene.path.file_stem().unwrap_or("results".as_ref()).to_owned();
    name.push(".h5");
    folder.join(name)
}

pub(crate) fn metadata(scene: &Scene, model: &Model) -> Metadata {
    let body = BodyReport::new(model);
    let method = scene.time.method;
    let (step, tolerance) = match scene.time.control {
        StepControl::Fixed(step) => (Some(step), None),
        StepControl::Tolerance(tolerance) => (None, Some(tolerance)),
    };
    Metadata {
        title: scene.title.clone(),
        units: Units {
            length: scene.units.length.clone(),
            mass: scene.units.mass.clone(),
            time: scene.units.time.clone(),
        },
        formulation: method.formulation.to_owned(),
        scheme: method.scheme.to_owned(),
        step,
        tolerance,
        program_version: env!("CARGO_PKG_VERSION").to_owned(),
        scene_text: scene.source.clone(),
        scene_file: scene_file::to_text(&scene.path),
        body: BodyProperties {
            mass: body.mass,
            center_of_mass: body.center_of_mass,
            inertia: body.inertia,
            origin: model.body.origin.into(),
            static_shapes: model.static_shapes(),
            frequencies: body.natural_frequencies,
            damping_ratios: body.damping_ratios,
        },
        point_names: model.points.iter().map(|(name, _)| name.clone()).collect(),
        point_positions: model.points.iter().map(|(_, p)| (model.body.origin + p.position_body()).into()).collect(),
        parts: parts(scene, model).map(str::to_owned).collect(),
    }
}

/// What the run has so that its file has further columns. In the formulation of the paper there are no reactions.
fn parts(scene: &Scene, model: &Model) -> impl Iterator<Item = &'static str> {
    let motion = &model.body.motion;
    let drive = model.physics.drive.as_ref().map(|drive| drive.motion);
    let turns = matches!(drive, Some(DrivenMotion::Turn { .. }));
    let slides = matches!(drive, Some(DrivenMotion::Slide { .. }));
    let is_held = !motion.is_free() && !scene.time.method.is_of_paper();
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
}

/// Follows a run, and turns its observations into rows of the results file.
struct Recorder<'a> {
    scene: &'a Scene,
    model: &'a Model,
    observation: Observation,
    writer: Writer<Observation>,
    review: Review<'a>,
    rows: u64,
    peak_strain_energy: f64,
    monitor: Monitor,
    /// What fixed steps are expected to get wrong.
    step: Option<StepEstimate>,
}

impl<'a> Recorder<'a> {
    fn new(
        scene: &'a Scene,
        model: &'a Model,
        initial: &'a Initial,
        writer: Writer<Observation>,
    ) -> Result<Self, RunError> {
        let step = model
            .step_estimate(scene)
            .map_err(|source| RunError::Setup { scene: scene.path.clone(), source: Box::new(source) })?;
        Ok(Self {
            scene,
            model,
            observation: Observation::new(model.body.flexible(), model.points.len()),
            writer,
            review: Review::new(model.case(scene, initial), model.physics.effects, &model.advice),
            rows: 0,
            peak_strain_energy: 0.0,
            monitor: Monitor::default(),
            step,
        })
    }

    /// Whether the steps are known to be right though they are too long for the sum of work and dissipation.
    fn is_right_unsummed(&self, longest_step: f64) -> bool {
        if self.scene.time.method.is_of_paper() {
            // The equations of the paper do not keep the energy in any steps.
            return false;
        }
        let frequencies = self.model.body.circular_frequencies.iter().zip(self.model.damping_ratios());
        let fastest = frequencies.map(|(omega, zeta)| omega * (2.0 * zeta).max(1.0)).fold(0.0, f64::max);
        let resolved = fastest * longest_step <= RESOLVED;
        match &self.step {
            Some(step) => step.largest() < WRONG && (step.seen >= 1.0 || !resolved),
            None => !resolved,
        }
    }

    /// The first row, and a first checkpoint.
    fn begin(&mut self, simulation: &mut Simulation) -> Result<(), RunError> {
        self.record(simulation)?;
        self.flush(simulation)
    }

    /// Takes the rows before a checkpoint into account, the last of which must be what the simulation is at.
    fn take_up(&mut self, simulation: &mut Simulation, results: &Results) -> Result<(), RunError> {
        let part = self.writer.unfinished().to_path_buf();
        let changed = |what| RunError::Changed { part: part.clone(), what };
        for row in 0..results.rows() {
            let past = restore(results, row, &mut self.observation).ok_or_else(|| changed("the columns"))?;
            self.review.observe(&self.observation).map_err(BuildError::from)?;
            self.monitor.take(&past);
            self.peak_strain_energy = self.peak_strain_energy.max(self.observation.strain_energy);
        }
        self.rows = results.rows() as u64;
        simulation.observe(&mut self.observation).map_err(|source| self.failed(source))?;
        match results.rows().checked_sub(1) {
            Some(last) if results.is_row(last, &COLUMNS, &self.observation) => Ok(()),
            _ => Err(changed("the motion at the checkpoint")),
        }
    }

    /// Goes on to the end.
    fn follow(
        mut self,
        mut simulation: Simulation,
        started: Instant,
        settings: &RunSettings,
        mut progress: impl FnMut(RunProgress),
    ) -> Result<RunReport, RunError> {
        let before = simulation.stats().accepted;
        loop {
            let review = &mut self.review;
            let reached = simulation.advance_watched(STEPS_PER_REPORT, |moment| review.look(moment));
            // A step that fails after the model has come to mean nothing fails for that.
            self.refuse()?;
            match reached.map_err(|source| self.failed(source))? {
                Reached::Row => {
                    self.record(&mut simulation)?;
                    let stop = settings.stop.load(Ordering::Relaxed) && simulation.time() < simulation.end();
                    if stop || self.writer.flush_is_due() {
                        self.flush(&mut simulation)?;
                    }
                    if stop {
                        let part = self.writer.unfinished().to_path_buf();
                        return Err(RunError::Stopped { part, time: simulation.time() });
                    }
                }
                // What has come since the last flush is computed again.
                Reached::Between if settings.stop.load(Ordering::Relaxed) => {
                    let part = self.writer.unfinished().to_path_buf();
                    return Err(RunError::Stopped { part, time: simulation.time() });
                }
                Reached::End => break,
                _ => {}
            }
            progress(RunProgress::Motion(simulation.time() / simulation.end()));
        }
        // Should there be no room for the results file, they can still be had from here.
        self.flush(&mut simulation)?;
        let time = started.elapsed();
        let stats = simulation.stats();
        let method = self.scene.time.method;
        self.monitor.exchanged(simulation.exchanged());
        let balances = self.monitor.balances();
        let right_unsummed = balances.energy > OPEN && self.is_right_unsummed(stats.longest);
        let Self { scene, model, .. } = self;
        let open =
            (balances.energy > OPEN && !right_unsummed).then(|| open_balance(balances.energy, model.body.flexible()));
        let wrong = self.step.as_ref().filter(|step| step.largest() >= WRONG);
        let last = &self.observation;
        let mut report = RunReport {
            title: scene.title.clone(),
            units: [&scene.units.length, &scene.units.mass, &scene.units.time].map(Clone::clone),
            rows: self.rows,
            formulation: method.formulation.to_owned(),
            scheme: method.scheme.to_owned(),
            tolerance: match scene.time.control {
                StepControl::Fixed(_) => None,
                StepControl::Tolerance(tolerance) => Some(tolerance),
            },
            steps: stats.accepted,
            rejected_steps: stats.rejected,
            step_lengths: [stats.shortest, stats.longest],
            evaluations: stats.evaluations,
            steps_per_second: (stats.accepted - before) as f64 / time.as_secs_f64(),
            mesh: MeshReport::new(model),
            body: BodyReport::new(model),
            turned: Attitude::identity().angle_to(&last.attitude),
            moved: (last.position_global - model.body.center_of_mass).into(),
            peak_strain_energy: self.peak_strain_energy,
            final_energy: last.energy(),
            balances,
            right_unsummed,
            effects: effects::computed(scene, model),
            warnings: (self.review.broken().iter().map(ToString::to_string))
                .chain(wrong.map(|step| long_steps(step, scene.effects.tolerance)))
                .chain(open)
                .collect(),
            results: self.writer.path().to_path_buf(),
            times: Times::of_model(model),
        };
        self.writer.finish()?;
        report.times.add("motion", started.elapsed());
        Ok(report)
    }

    /// Refuses to go on where the review has found that the model is wrong, unless the scene wants to.
    fn refuse(&self) -> Result<(), RunError> {
        match self.review.stop() {
            Some((time, refusal)) if self.scene.effects.refuse => {
                Err(RunError::Refused { results: self.writer.unfinished().to_path_buf(), time, refusal })
            }
            _ => Ok(()),
        }
    }

    fn failed(&self, source: StepError) -> RunError {
        RunError::Step { results: self.writer.unfinished().to_path_buf(), source }
    }

    /// Writes the row of the time that `simulation` has reached.
    fn record(&mut self, simulation: &mut Simulation) -> Result<(), RunError> {
        simulation.observe(&mut self.observation).map_err(|source| self.failed(source))?;
        let now = &self.observation;
        // It refuses what is not finite.
        self.writer.push(now)?;
        self.peak_strain_energy = self.peak_strain_energy.max(now.strain_energy);
        self.monitor.watch(now);
        self.review.observe(now).map_err(BuildError::from)?;
        self.rows += 1;
        Ok(())
    }

    /// Hands the rows to the operating system, with the state after the last.
    fn flush(&mut self, simulation: &mut Simulation) -> Result<(), RunError> {
        let part = || self.writer.unfinished().to_path_buf();
        let checkpoint = simulation.checkpoint().map_err(|source| RunError::Restore { part: part(), source })?;
        Ok(self.writer.flush(&checkpoint)?)
    }
}

/// Reads a row back as far as the review and the monitor look at it.
fn restore(results: &Results, row: usize, out: &mut Observation) -> Option<Conserved> {
    let number = |path| results.numbers(path)?.get(row).copied();
    let vector = |path| results.vectors(path)?.get(row).copied().map(Vector3::from);
    let modal = |path| results.table(path)?.row(row);
    out.time = number("time")?;
    out.omega_body = vector("angular_velocity")?;
    out.modal_displacement.clear();
    out.modal_displacement.extend(modal("modal/displacement")?);
    out.modal_velocity.clear();
    out.modal_velocity.extend(modal("modal/velocity")?);
    out.kinetic_energy = number("energy/kinetic")?;
    out.strain_energy = number("energy/strain")?;
    Some(Conserved {
        quantities: (out.energy(), vector("momentum/linear")?, vector("momentum/angular")?),
        balances: (number("energy/balance")?, vector("momentum/linear_balance")?, vector("momentum/angular_balance")?),
    })
}

/// Energy, and linear and angular momentum.
type Momenta = (f64, Vector3<f64>, Vector3<f64>);

/// Quantities that exact motion conserves, and what is left of them without what the loads and damping have done.
struct Conserved {
    quantities: Momenta,
    balances: Momenta,
}

/// Watches the constants of the motion.
#[derive(Debug, Clone, Default)]
pub(crate) struct Monitor {
    start: Option<Momenta>,
    changes: Balances,
    scales: Balances,
}

impl Monitor {
    /// Takes one more observation into account.
    pub(crate) fn watch(&mut self, now: &Observation) {
        self.take(&Conserved {
            quantities: (now.energy(), now.linear_momentum_global, now.angular_momentum_global),
            balances: (now.energy_balance(), now.linear_balance_global(), now.angular_balance_global()),
        });
    }

    fn take(&mut self, Conserved { quantities, balances }: &Conserved) {
        let start = self.start.get_or_insert(*balances);
        let grow = |largest: &mut f64, value: f64| *largest = largest.max(value.abs());
        grow(&mut self.changes.energy, balances.0 - start.0);
        grow(&mut self.changes.linear_momentum, (balances.1 - start.1).norm());
        grow(&mut self.changes.angular_momentum, (balances.2 - start.2).norm());
        grow(&mut self.scales.energy, quantities.0);
        grow(&mut self.scales.linear_momentum, quantities.1.norm());
        grow(&mut self.scales.angular_momentum, quantities.2.norm());
    }

    /// Takes into account how much energy has come and gone between the rows: they may all fall where there is none.
    fn exchanged(&mut self, energy: f64) {
        self.scales.energy = self.scales.energy.max(energy);
    }

    /// Largest changes so far, relative to the largest values.
    pub(crate) fn balances(&self) -> Balances {
        let relative = |change: f64, scale: f64| if change > 0.0 { change / scale } else { 0.0 };
        Balances {
            energy: relative(self.changes.energy, self.scales.energy),
            linear_momentum: relative(self.changes.linear_momentum, self.scales.linear_momentum),
            angular_momentum: relative(self.changes.angular_momentum, self.scales.angular_momentum),
        }
    }
}

impl RunReport {
    /// Method and steps, such as "conservative form, scheme exponential, 5000 steps of 1e-4 s".
    pub(crate) fn steps_in_words(&self) -> String {
        let time = &self.units[2];
        let form = match self.formulation.as_str() {
            "paper" => "paper's",
            _ => "conservative",
        };
        let [shortest, longest] = self.step_lengths;
        let lengths = if longest - shortest <= 1e-9 * longest {
            format!("of {longest:.6e} {time}")
        } else {
            format!("from {shortest:.3e} to {longest:.3e} {time}")
        };
        let control = match self.tolerance {
            Some(tolerance) => format!(" ({} rejected, tolerance {tolerance:e})", self.rejected_steps),
            None => String::new(),
        };
        format!("{form} form, scheme {}, {} steps{control} {lengths}", self.scheme, self.steps)
    }
}

impl fmt::Display for RunReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [length, mass, time] = &self.units;
        writeln!(f, "{}", self.title)?;
        if let Some(mesh) = &self.mesh {
            writeln!(f, "  mesh     {mesh}")?;
        }
        write!(f, "  body     {} {mass}, ", quantity(self.body.mass))?;
        writeln!(f, "{}", self.body.modes_in_words(&frequency_unit(time)))?;
        if !self.effects.is_empty() {
            writeln!(f, "  effects  {}", effects::in_words(&self.effects))?;
        }
        writeln!(f, "  motion   {}, {:.0} steps per second", self.steps_in_words(), self.steps_per_second)?;
        let [x, y, z] = self.moved.map(quantity);
        writeln!(
            f,
            "  end      turned by {} rad, centre of mass moved by ({x}, {y}, {z}) {length}",
            quantity(self.turned)
        )?;
        writeln!(
            f,
            "  energy   {} at the end, largest strain energy {}, {mass} {length}²/{time}²",
            quantity(self.final_energy),
            quantity(self.peak_strain_energy)
        )?;
        let Balances { energy, linear_momentum, angular_momentum } = self.balances;
        let closed = if self.right_unsummed {
            format!("known to {energy:.1e} only, by modes faster than the steps")
        } else {
            format!("closed to {energy:.1e}")
        };
        writeln!(
            f,
            "  balance  energy {closed}, linear momentum to {linear_momentum:.1e}, angular momentum to \
             {angular_momentum:.1e}"
        )?;
        writeln!(f, "  time     {}", self.times)?;
        write!(f, "  results  {} ({} rows)", self.results.display(), self.rows)?;
        for warning in &self.warnings {
            write!(f, "\n  warning  {warning}")?;
        }
        Ok(())
    }
}
