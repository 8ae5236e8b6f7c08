//! From the motion to the rows of the results file.

use std::sync::atomic::Ordering;
use std::time::Instant;

use dynamics::{Initial, Observation, Reached, Simulation, Stats, StepError};
use model::Model;
use nalgebra::Vector3;
use results::{Results, Writer};
use rigid_kin::Attitude;
use scene::{Scene, StepControl};

use super::balances::Conserved;
use super::error::RunError;
use super::estimate::Estimate;
use super::report::RunReport;
use super::settings::{RunProgress, RunSettings};
use super::watch::{Watch, Watched};
use crate::drawn::not_stored;
use crate::report::{BodyReport, MeshReport, Times};
use crate::rows::columns::COLUMNS;
use crate::rows::effects;
use crate::rows::peak_stress::Largest;
use crate::rows::row::Row;

/// Steps between two reports of progress, where no row comes first.
const STEPS_PER_REPORT: u64 = 4096;

/// Steps from one row with a report of progress and a look at the clock to the next: a row may cost less than these.
const STEPS_PER_LOOK: u64 = 64;

/// Follows a run, and turns its observations into rows of the results file.
pub(super) struct Recorder<'a> {
    scene: &'a Scene,
    model: &'a Model,
    row: Row,
    writer: Writer<Row>,
    watch: Watch<'a>,
    rows: u64,
    peak_strain_energy: f64,
    peak_stress: Option<Largest>,
    first_attitude: Attitude,
    /// Centre of mass of the undeformed body at the start, global.
    first_center: Vector3<f64>,
    estimate: Estimate,
}

impl<'a> Recorder<'a> {
    pub fn new(
        scene: &'a Scene,
        model: &'a Model,
        initial: &'a Initial,
        writer: Writer<Row>,
        estimate: Estimate,
    ) -> Result<Self, RunError> {
        let (origin, center) = (model.body.origin, model.body.center_of_mass);
        let first_center = initial.origin.unwrap_or(origin) + initial.attitude.to_global(&(center - origin));
        Ok(Self {
            scene,
            model,
            row: Row::new(model),
            writer,
            watch: Watch::new(scene, model, initial, model.physics.effects)?,
            rows: 0,
            peak_strain_energy: 0.0,
            peak_stress: None,
            first_attitude: initial.attitude,
            first_center,
            estimate,
        })
    }

    /// The first row, and a first checkpoint.
    pub fn begin(&mut self, simulation: &mut Simulation) -> Result<(), RunError> {
        self.record(simulation)?;
        self.flush(simulation)
    }

    /// Takes the rows before a checkpoint into account, the last of which must be what the simulation is at.
    pub fn take_up(&mut self, simulation: &mut Simulation, results: &Results) -> Result<(), RunError> {
        let part = self.writer.unfinished().to_path_buf();
        let changed = |what| RunError::Changed { part: part.clone(), what };
        for row in 0..results.rows() {
            let past = restore(results, row, &mut self.row.motion).ok_or_else(|| changed("the columns"))?;
            self.watch.take_up(&self.row, &past)?;
            self.peak_strain_energy = self.peak_strain_energy.max(self.row.strain_energy);
            Largest::watch(&mut self.peak_stress, self.model, &self.row);
        }
        self.rows = results.rows() as u64;
        self.observe(simulation)?;
        match results.rows().checked_sub(1) {
            Some(last) if results.is_row(last, &COLUMNS, &self.row) => Ok(()),
            _ => Err(changed("the motion at the checkpoint")),
        }
    }

    /// Goes on to the end.
    pub fn follow(
        mut self,
        mut simulation: Simulation,
        started: Instant,
        settings: &RunSettings,
        mut progress: impl FnMut(RunProgress),
    ) -> Result<RunReport, RunError> {
        let before = simulation.stats().accepted;
        let mut looked_at = 0;
        loop {
            let watch = &mut self.watch;
            let reached = simulation.advance_watched(STEPS_PER_REPORT, |moment| watch.look(moment));
            // A step that fails after the model has come to mean nothing fails for that.
            self.refuse()?;
            match reached.map_err(|source| self.failed(source))? {
                Reached::Row => {
                    self.record(&mut simulation)?;
                    let stop = settings.stop.load(Ordering::Relaxed) && simulation.time() < simulation.end();
                    let Stats { accepted, rejected, .. } = simulation.stats();
                    if !stop && accepted + rejected < looked_at + STEPS_PER_LOOK {
                        continue;
                    }
                    looked_at = accepted + rejected;
                    if stop || self.writer.flush_is_due() {
                        self.flush(&mut simulation)?;
                    }
                    if stop {
                        return Err(self.stopped(&simulation, settings));
                    }
                }
                // What has come since the last flush is computed again.
                Reached::Between if settings.stop.load(Ordering::Relaxed) => {
                    return Err(self.stopped(&simulation, settings));
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
        let Watched { balances, right_unsummed, left_out, turned, mut warnings } = self.watch.finish(&simulation);
        let Self { scene, model, .. } = self;
        warnings.extend(not_stored(scene, model));
        let last = &self.row;
        let mut report = RunReport {
            title: scene.title.clone(),
            units: [&scene.units.length, &scene.units.mass, &scene.units.time].map(Clone::clone),
            rows: self.rows,
            estimate: self.estimate,
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
            turned: if model.body.motion.rotations().len() == 1 { last.reaction.hinge_angle } else { turned },
            turned_from_start: self.first_attitude.angle_to(&last.attitude),
            moved: (last.position_global - self.first_center).into(),
            peak_strain_energy: self.peak_strain_energy,
            peak_stress: self.peak_stress.as_ref().and_then(|peak| peak.report(model)),
            final_energy: last.energy(),
            balances,
            right_unsummed,
            effects: effects::computed(scene, model),
            large_modes: model.large_modes().iter().map(|k| k + 1).collect(),
            left_out,
            warnings,
            results: self.writer.path().to_path_buf(),
            times: Times::of_model(model),
        };
        self.writer.warn(report.warnings.clone());
        self.writer.finish()?;
        report.times.add("motion", started.elapsed());
        Ok(report)
    }

    /// Refuses to go on where the review has found that the model is wrong, unless the scene wants to.
    fn refuse(&self) -> Result<(), RunError> {
        match self.watch.refusal() {
            Some((time, refusal)) => {
                Err(RunError::Refused { results: self.writer.unfinished().to_path_buf(), time, refusal })
            }
            None => Ok(()),
        }
    }

    fn stopped(&self, simulation: &Simulation, settings: &RunSettings) -> RunError {
        let replaces = settings.overwrite && self.writer.path().exists();
        RunError::Stopped { part: self.writer.unfinished().to_path_buf(), time: simulation.time(), replaces }
    }

    fn failed(&self, source: StepError) -> RunError {
        RunError::Step { results: self.writer.unfinished().to_path_buf(), source }
    }

    /// Observes the motion at the time that `simulation` has reached.
    fn observe(&mut self, simulation: &mut Simulation) -> Result<(), RunError> {
        simulation.observe(&mut self.row.motion).map_err(|source| self.failed(source))?;
        self.row.complete(self.model);
        Ok(())
    }

    /// Writes the row of the time that `simulation` has reached.
    fn record(&mut self, simulation: &mut Simulation) -> Result<(), RunError> {
        self.observe(simulation)?;
        let now = &self.row;
        // It refuses what is not finite.
        self.writer.push(now)?;
        self.peak_strain_energy = self.peak_strain_energy.max(now.strain_energy);
        Largest::watch(&mut self.peak_stress, self.model, now);
        self.watch.observe(now)?;
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

/// Reads a row back as far as the review, the monitor and the stress look at it.
fn restore(results: &Results, row: usize, out: &mut Observation) -> Option<Conserved> {
    let number = |path| results.numbers(path)?.get(row).copied();
    let vector = |path| results.vectors(path)?.get(row).copied().map(Vector3::from);
    let modal = |path| results.table(path)?.row(row);
    out.time = number("time")?;
    out.attitude = Attitude::from_unit_wxyz(*results.vectors("attitude")?.get(row)?).ok()?;
    out.omega_body = vector("angular_velocity")?;
    out.alpha_body = vector("angular_acceleration")?;
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
