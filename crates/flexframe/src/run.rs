//! `flexframe run`: a scene from its mesh to its results file.

use std::fmt;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use frames_rk4::{BodyMotion, PaperScheme, SetupError, State, StepError};
use results::{BodyProperties, FileError, Metadata, PointSample, Sample, Units, Writer};
use rigid_kin::{Attitude, InertiaError};
use scene::{BuildError, BuildProgress, Model, Scene};
use serde::Serialize;

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
        source: SetupError,
    },
    /// The inertia is none of a rigid body.
    #[error(transparent)]
    Inertia(#[from] InertiaError),
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
    /// The output folder cannot be made.
    #[error("{}: cannot make the output folder: {source}", folder.display())]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// Why.
        source: std::io::Error,
    },
}

/// How far a run has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RunProgress {
    /// The model is being built.
    Build(BuildProgress),
    /// Steps done, of all.
    Steps {
        /// Done.
        done: u64,
        /// All.
        total: u64,
    },
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
    /// Scheme.
    pub scheme: String,
    /// Length of a step.
    pub step: f64,
    /// Steps taken.
    pub steps: u64,
    /// Steps per second of computing, writing included.
    pub steps_per_second: f64,
    /// The finite-element model.
    pub mesh: MeshReport,
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
    /// Where the time went, seconds.
    pub times: Times,
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
    let (steps, step) = scene.steps();
    let mut scheme =
        model.start(scene, step).map_err(|source| RunError::Setup { scene: scene.path.clone(), source })?;
    std::fs::create_dir_all(folder).map_err(|source| RunError::Folder { folder: folder.to_owned(), source })?;
    let path = results_path(scene, folder);
    let metadata = metadata(scene, &model, step);
    let mut recorder = Recorder::new(&model, Writer::create(&path, &metadata)?)?;
    recorder.record(scheme.state())?;
    advance(scene, &mut scheme, steps, &mut recorder, &path, &mut progress)?;
    let last = scheme.state();
    let report = |times: Times, time: Duration| RunReport {
        title: scene.title.clone(),
        units: [&scene.units.length, &scene.units.mass, &scene.units.time].map(Clone::clone),
        results: path.clone(),
        rows: recorder.rows,
        scheme: metadata.scheme.clone(),
        step,
        steps,
        steps_per_second: steps as f64 / time.as_secs_f64(),
        mesh: MeshReport::new(scene, &model),
        body: BodyReport::new(&model),
        turned: Attitude::identity().angle_to(&last.attitude),
        moved: (recorder.motion.position_global(last) - model.body.center_of_mass).into(),
        peak_strain_energy: recorder.peak_strain_energy,
        final_energy: recorder.motion.kinetic_energy(last) + recorder.motion.strain_energy(last),
        times,
    };
    let time = started.elapsed();
    times.add("motion", time);
    let report = report(times, time);
    recorder.writer.finish()?;
    Ok((model, report))
}

/// The results file of a scene in a folder.
pub fn results_path(scene: &Scene, folder: &Path) -> PathBuf {
    folder.join(scene.path.file_stem().unwrap_or("results".as_ref())).with_extension("h5")
}

/// Does all steps and records every so many of them, and the last.
fn advance(
    scene: &Scene,
    scheme: &mut PaperScheme,
    steps: u64,
    recorder: &mut Recorder,
    path: &Path,
    progress: &mut impl FnMut(RunProgress),
) -> Result<(), RunError> {
    const STEPS_PER_REPORT: u64 = 2048;
    for done in 1..=steps {
        let state = scheme.step().map_err(|source| RunError::Step { results: path.to_owned(), source })?;
        if done % scene.output.every as u64 == 0 || done == steps {
            recorder.record(state)?;
        }
        if done % STEPS_PER_REPORT == 0 || done == steps {
            progress(RunProgress::Steps { done, total: steps });
        }
    }
    Ok(())
}

fn metadata(scene: &Scene, model: &Model, step: f64) -> Metadata {
    let body = BodyReport::new(model);
    Metadata {
        title: scene.title.clone(),
        units: Units {
            length: scene.units.length.clone(),
            mass: scene.units.mass.clone(),
            time: scene.units.time.clone(),
        },
        scheme: "paper".to_owned(),
        step,
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

/// Turns states into rows of the results file.
struct Recorder<'a> {
    model: &'a Model,
    motion: BodyMotion,
    writer: Writer,
    points: Vec<PointSample>,
    rows: u64,
    peak_strain_energy: f64,
}

impl<'a> Recorder<'a> {
    fn new(model: &'a Model, writer: Writer) -> Result<Self, RunError> {
        Ok(Self {
            model,
            motion: BodyMotion::new(&model.body)?,
            writer,
            points: Vec::with_capacity(model.points.len()),
            rows: 0,
            peak_strain_energy: 0.0,
        })
    }

    fn record(&mut self, state: &State) -> Result<(), RunError> {
        let motion = &self.motion;
        self.points.clear();
        self.points.extend(self.model.points.iter().map(|(_, point)| {
            let point = motion.point(state, point);
            PointSample {
                displacement: point.displacement.into(),
                velocity: point.velocity.into(),
                acceleration: point.acceleration.into(),
                rigid_acceleration: point.rigid_acceleration.into(),
            }
        }));
        let strain_energy = motion.strain_energy(state);
        self.peak_strain_energy = self.peak_strain_energy.max(strain_energy);
        self.writer.push(&Sample {
            time: state.time,
            attitude: state.attitude.wxyz(),
            position: motion.position_global(state).into(),
            velocity: motion.velocity_global(state).into(),
            angular_velocity: state.omega_body.into(),
            angular_acceleration: state.alpha_body.into(),
            modal_displacement: &state.modal_displacement[6..],
            modal_velocity: &state.modal_velocity[6..],
            kinetic_energy: motion.kinetic_energy(state),
            strain_energy,
            linear_momentum: motion.linear_momentum_global(state).into(),
            angular_momentum: motion.angular_momentum_global(state).into(),
            points: &self.points,
        })?;
        self.rows += 1;
        Ok(())
    }
}

impl fmt::Display for RunReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [length, mass, time] = &self.units;
        let frequencies = &self.body.natural_frequencies;
        writeln!(f, "{}", self.title)?;
        writeln!(f, "  mesh     {}", self.mesh)?;
        write!(f, "  body     {} {mass}, ", quantity(self.body.mass))?;
        match (frequencies.first(), frequencies.last()) {
            (Some(first), Some(last)) => writeln!(
                f,
                "{} flexible modes from {first:.4} to {last:.4} {}",
                frequencies.len(),
                frequency_unit(time)
            )?,
            _ => writeln!(f, "rigid")?,
        }
        writeln!(
            f,
            "  motion   scheme {}, {} steps of {:e} {time}, {:.0} steps per second",
            self.scheme, self.steps, self.step, self.steps_per_second
        )?;
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
        writeln!(f, "  time     {}", self.times)?;
        write!(f, "  results  {} ({} rows)", self.results.display(), self.rows)
    }
}
