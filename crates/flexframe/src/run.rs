//! `flexframe run`: a scene from its mesh to its results file.

use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Instant;

use advice::{AdviceError, Review};
use frames_rk4::{Observation, Reached, Simulation, StepError};
use nalgebra::Vector3;
use results::{BodyProperties, FileError, Metadata, PointSample, Sample, Units, Writer};
use rigid_kin::Attitude;
use scene::{BuildError, BuildProgress, Model, Scene, StartError, Stepping};
use serde::Serialize;

use crate::effects;
use crate::modes::frequency_unit;
use crate::report::{BodyReport, MeshReport, Times, quantity};

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
        source: StartError,
    },
    /// A step failed. The states before it are in the results file.
    #[error("{source} (the states before it are in {results})", results = results.display())]
    Step {
        /// The results file.
        results: PathBuf,
        /// Why.
        source: StepError,
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
        failure: RunFailure,
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
    pub step_lengths: [f64; 2],
    /// Evaluations of the rates.
    pub evaluations: u64,
    /// Steps per second of computing, writing included.
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
    pub peak_strain_energy: f64,
    /// Kinetic plus strain energy of the last row.
    pub final_energy: f64,
    /// How far the balances are from closed.
    pub balances: Balances,
    /// The effects of this body and whether each was computed; none of the paper's formulation, which has its own.
    pub effects: Vec<(&'static str, bool)>,
    /// Assumptions that did not hold.
    pub warnings: Vec<String>,
    /// Where the time went, seconds.
    pub times: Times,
}

/// Largest changes, over the rows, of what should be constants of the motion, relative to the largest value of the
/// quantity itself.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub struct Balances {
    /// Energy − work of the loads + dissipation.
    pub energy: f64,
    /// Linear momentum less the impulse of the loads.
    pub linear_momentum: f64,
    /// Angular momentum about the centre of mass less the angular impulse of the loads.
    pub angular_momentum: f64,
}

/// Runs a scene and writes its results to `<folder>/<name of the scene file>.h5`. `progress` hears how far it is, at
/// every phase and every few thousand steps.
///
/// # Errors
/// [`RunError`]. When a step fails, the file keeps the rows before it and says that it is not complete.
pub fn run(
    scene: &Scene,
    folder: &Path,
    mut progress: impl FnMut(RunProgress),
) -> Result<(Model, RunReport), RunError> {
    let model = Model::build(scene, |p| progress(RunProgress::Build(p)))?;
    let mut times = Times::of_model(&model);

    let started = Instant::now();
    let mut simulation = model.start(scene).map_err(|source| RunError::Setup { scene: scene.path.clone(), source })?;
    std::fs::create_dir_all(folder).map_err(|source| RunError::Folder { folder: folder.to_owned(), source })?;
    let path = results_path(scene, folder);
    let metadata = metadata(scene, &model);
    let initial = model.initial(scene);
    let review = Review::new(model.case(scene, &initial), model.physics.effects, &model.advice);
    let writer = Writer::create(&path, &metadata)?;
    let mut recorder = Recorder::new(&model, simulation.observation(), writer, review);
    let failed = |source| RunError::Step { results: path.clone(), source };
    recorder.record(&mut simulation).map_err(|error| error.unless_file(failed))?;
    loop {
        match simulation.advance(STEPS_PER_REPORT).map_err(failed)? {
            Reached::Row => recorder.record(&mut simulation).map_err(|error| error.unless_file(failed))?,
            Reached::Between => {}
            Reached::End => break,
        }
        progress(RunProgress::Motion(simulation.time() / simulation.end()));
    }
    let time = started.elapsed();
    let stats = simulation.stats();
    let last = &recorder.observation;
    let mut report = RunReport {
        title: scene.title.clone(),
        units: [&scene.units.length, &scene.units.mass, &scene.units.time].map(Clone::clone),
        rows: recorder.rows,
        formulation: metadata.formulation,
        scheme: metadata.scheme,
        tolerance: metadata.tolerance,
        steps: stats.accepted,
        rejected_steps: stats.rejected,
        step_lengths: [stats.shortest, stats.longest],
        evaluations: stats.evaluations,
        steps_per_second: stats.accepted as f64 / time.as_secs_f64(),
        mesh: MeshReport::new(&model),
        body: BodyReport::new(&model),
        turned: Attitude::identity().angle_to(&last.attitude),
        moved: (last.position_global - model.body.center_of_mass).into(),
        peak_strain_energy: recorder.peak_strain_energy,
        final_energy: last.energy(),
        balances: recorder.monitor.balances(),
        effects: effects::computed(scene, &model),
        warnings: recorder
            .review
            .broken()
            .iter()
            .map(ToString::to_string)
            .chain(open_balance(&recorder.monitor))
            .collect(),
        results: path,
        times: Times::default(),
    };
    recorder.writer.finish()?;
    times.add("motion", started.elapsed());
    report.times = times;
    Ok((model, report))
}

/// Energy balance from which on a run says that it is open.
const OPEN: f64 = 1e-2;

fn open_balance(monitor: &Monitor) -> Option<String> {
    let open = monitor.balances().energy;
    (open > OPEN).then(|| {
        format!(
            "the energy balance is open by {open:.1e}: the work on modes that are faster than the step is summed too \
             coarsely, or the motion itself is; take shorter steps, or fewer modes, until it does not matter to the answer"
        )
    })
}

/// Steps between two reports of progress, where no row comes first.
const STEPS_PER_REPORT: u64 = 4096;

/// The results file of a scene in a folder.
pub fn results_path(scene: &Scene, folder: &Path) -> PathBuf {
    folder.join(scene.path.file_stem().unwrap_or("results".as_ref())).with_extension("h5")
}

fn metadata(scene: &Scene, model: &Model) -> Metadata {
    let body = BodyReport::new(model);
    let method = scene::method(scene.time.method);
    let (step, tolerance) = match scene.time.stepping {
        Stepping::Step(step) => (Some(step), None),
        Stepping::Tolerance(tolerance) => (None, Some(tolerance)),
    };
    Metadata {
        title: scene.title.clone(),
        units: Units {
            length: scene.units.length.clone(),
            mass: scene.units.mass.clone(),
            time: scene.units.time.clone(),
        },
        formulation: method.formulation().to_owned(),
        scheme: method.scheme().to_owned(),
        step,
        tolerance,
        program_version: env!("CARGO_PKG_VERSION").to_owned(),
        scene_text: scene.source.clone(),
        body: BodyProperties {
            mass: body.mass,
            center_of_mass: body.center_of_mass,
            inertia: body.inertia,
            frequencies: body.natural_frequencies,
            damping_ratios: body.damping_ratios,
        },
        point_names: model.points.iter().map(|(name, _)| name.clone()).collect(),
    }
}

/// Turns observations into rows of the results file.
struct Recorder<'a> {
    observation: Observation,
    writer: Writer,
    review: Review<'a>,
    points: Vec<PointSample>,
    rows: u64,
    peak_strain_energy: f64,
    monitor: Monitor,
}

/// Why a row could not be recorded.
enum RecordError {
    Step(StepError),
    File(FileError),
    Review(AdviceError),
}

impl RecordError {
    fn unless_file(self, step: impl FnOnce(StepError) -> RunError) -> RunError {
        match self {
            Self::Step(error) => step(error),
            Self::File(error) => error.into(),
            Self::Review(error) => BuildError::from(error).into(),
        }
    }
}

impl<'a> Recorder<'a> {
    fn new(model: &Model, observation: Observation, writer: Writer, review: Review<'a>) -> Self {
        let points = Vec::with_capacity(model.points.len());
        let monitor = Monitor::default();
        Self { observation, writer, review, points, rows: 0, peak_strain_energy: 0.0, monitor }
    }

    /// Writes the row of the time that `simulation` has reached.
    fn record(&mut self, simulation: &mut Simulation) -> Result<(), RecordError> {
        simulation.observe(&mut self.observation).map_err(RecordError::Step)?;
        let now = &self.observation;
        self.points.clear();
        self.points.extend(now.points.iter().map(|point| PointSample {
            displacement: point.displacement.into(),
            velocity: point.velocity.into(),
            acceleration: point.acceleration.into(),
            rigid_acceleration: point.rigid_acceleration.into(),
        }));
        self.peak_strain_energy = self.peak_strain_energy.max(now.strain_energy);
        self.monitor.watch(now);
        self.review.observe(now).map_err(RecordError::Review)?;
        self.writer
            .push(&Sample {
                time: now.time,
                attitude: now.attitude.wxyz(),
                position: now.position_global.into(),
                velocity: now.velocity_global.into(),
                angular_velocity: now.omega_body.into(),
                angular_acceleration: now.alpha_body.into(),
                modal_displacement: &now.modal_displacement,
                modal_velocity: &now.modal_velocity,
                kinetic_energy: now.kinetic_energy,
                strain_energy: now.strain_energy,
                work: now.work.work,
                dissipation: now.work.dissipation,
                energy_balance: now.energy_balance(),
                linear_momentum: now.linear_momentum_global.into(),
                angular_momentum: now.angular_momentum_global.into(),
                linear_balance: now.linear_balance_global().into(),
                angular_balance: now.angular_balance_global().into(),
                points: &self.points,
            })
            .map_err(RecordError::File)?;
        self.rows += 1;
        Ok(())
    }
}

/// Watches the constants of the motion.
#[derive(Debug, Clone, Default)]
pub(crate) struct Monitor {
    start: Option<(f64, Vector3<f64>, Vector3<f64>)>,
    changes: Balances,
    scales: Balances,
}

impl Monitor {
    /// Takes one more observation into account.
    pub(crate) fn watch(&mut self, now: &Observation) {
        let balance = (now.energy_balance(), now.linear_balance_global(), now.angular_balance_global());
        let start = self.start.get_or_insert(balance);
        let grow = |largest: &mut f64, value: f64| *largest = largest.max(value.abs());
        grow(&mut self.changes.energy, balance.0 - start.0);
        grow(&mut self.changes.linear_momentum, (balance.1 - start.1).norm());
        grow(&mut self.changes.angular_momentum, (balance.2 - start.2).norm());
        grow(&mut self.scales.energy, now.energy());
        grow(&mut self.scales.linear_momentum, now.linear_momentum_global.norm());
        grow(&mut self.scales.angular_momentum, now.angular_momentum_global.norm());
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
        let frequencies = &self.body.natural_frequencies;
        writeln!(f, "{}", self.title)?;
        if let Some(mesh) = &self.mesh {
            writeln!(f, "  mesh     {mesh}")?;
        }
        write!(f, "  body     {} {mass}, ", quantity(self.body.mass))?;
        match (frequencies.first(), frequencies.last()) {
            (Some(first), Some(last)) => {
                let shapes = match self.body.static_shapes() {
                    0 => String::new(),
                    count => format!(" and {count} static shapes"),
                };
                let modes = frequencies.len() - self.body.static_shapes();
                writeln!(f, "{modes} flexible modes{shapes} from {first:.4} to {last:.4} {}", frequency_unit(time))?;
            }
            _ => writeln!(f, "rigid")?,
        }
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
        writeln!(
            f,
            "  balance  energy closed to {energy:.1e}, linear momentum to {linear_momentum:.1e}, angular momentum to \
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
