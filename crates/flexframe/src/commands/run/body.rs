//! One body of a run on its way.

use dynamics::{Initial, Reached, Simulation, StepError};
use model::Model;
use nalgebra::Vector3;
use results::BodyResults;
use rigid_kin::Attitude;
use scene::Scene;

use super::balances::Conserved;
use super::body_report::BodyRunReport;
use super::error::RunError;
use super::row_times::RowTimes;
use super::watch::{Watch, Watched};
use crate::report::{BodyReport, MeshReport};
use crate::rows::effects;
use crate::rows::peak_stress::Largest;
use crate::rows::row::BodyRow;

/// Steps between two reports of progress, where no row comes first.
pub(super) const STEPS_PER_REPORT: u64 = 4096;

/// A body that is to run: its scene and its model.
#[derive(Debug, Clone, Copy)]
pub struct RunBody<'a> {
    /// Its scene.
    pub scene: &'a Scene,
    /// Its model, built of this scene.
    pub model: &'a Model,
}

impl RunBody<'_> {
    /// Name of the body, which is `body` where the scene gives none.
    pub fn name(&self) -> &str {
        name(self.scene)
    }
}

/// Name of the body of a scene.
pub(super) fn name(scene: &Scene) -> &str {
    scene.name.as_deref().unwrap_or("body")
}

/// Where a body goes next.
#[derive(Debug, Clone, Copy)]
pub(super) enum Next {
    /// To its own next row.
    Row,
    /// To a time, or beyond it by less than a step.
    Time(f64),
}

/// A body on its way.
pub(super) struct MovingBody<'a> {
    pub of: RunBody<'a>,
    simulation: Simulation,
    watch: Watch<'a>,
    peak_strain_energy: f64,
    peak_stress: Option<Largest>,
    first_attitude: Attitude,
    /// Centre of mass of the undeformed body at the start, global.
    first_center: Vector3<f64>,
}

impl<'a> MovingBody<'a> {
    pub fn new(of: RunBody<'a>, initial: &'a Initial, simulation: Simulation) -> Result<Self, RunError> {
        let RunBody { scene, model } = of;
        let (origin, center) = (model.body.origin, model.body.center_of_mass);
        let first_center = initial.origin.unwrap_or(origin) + initial.attitude.to_global(&(center - origin));
        Ok(Self {
            of,
            simulation,
            watch: Watch::new(scene, model, initial, model.physics.effects)?,
            peak_strain_energy: 0.0,
            peak_stress: None,
            first_attitude: initial.attitude,
            first_center,
        })
    }

    /// The motion.
    pub fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    /// Keeps what [`Self::observe`] needs at times between steps.
    pub fn keep_last_step(&mut self) {
        self.simulation.keep_last_step();
    }

    /// Takes a row before a checkpoint into account. `None` where the file lacks a column.
    pub fn take_up(
        &mut self,
        results: BodyResults<'_>,
        (row, time): (usize, f64),
        out: &mut BodyRow,
    ) -> Option<Result<(), RunError>> {
        let past = restore(results, row, time, out)?;
        let seen = self.watch.take_up(out, &past);
        self.see(out);
        Some(seen)
    }

    /// Goes on, at the most by as many steps as there are between two reports. Gives [`Reached::Row`] where it has come to.
    ///
    /// # Errors
    /// A step that failed; but [`Self::refusal`] comes before it.
    pub fn go(&mut self, next: Next, times: Option<&RowTimes>) -> Result<Reached, StepError> {
        let Self { simulation, watch, .. } = self;
        match (next, times) {
            (Next::Time(time), Some(times)) => {
                let before = simulation.stats();
                let tried = |simulation: &Simulation| {
                    let now = simulation.stats();
                    now.accepted + now.rejected - before.accepted - before.rejected
                };
                while simulation.time() < time && !times.are_same(simulation.time(), time) {
                    let left = STEPS_PER_REPORT.saturating_sub(tried(simulation));
                    if left == 0 {
                        return Ok(Reached::Between);
                    }
                    // Its own rows may be beyond the time by many steps.
                    let tries = if times.may_be_between_steps() { 1 } else { left };
                    simulation.advance_watched(tries, |moment| watch.look(moment))?;
                }
                Ok(Reached::Row)
            }
            _ => simulation.advance_watched(STEPS_PER_REPORT, |moment| watch.look(moment)),
        }
    }

    /// Refusal to go on, and since when, where the review has found that the model is wrong, unless the scene wants to.
    pub fn refusal(&self) -> Option<(f64, advice::Refusal)> {
        self.watch.refusal()
    }

    /// Observes the motion at the time that it has come to, or at the time of a row within its last step.
    pub fn observe(&mut self, at: Option<f64>, out: &mut BodyRow) -> Result<(), StepError> {
        match at {
            Some(time) => self.simulation.interpolate(time, &mut out.motion)?,
            None => self.simulation.observe(&mut out.motion)?,
        }
        out.complete(self.of.model);
        Ok(())
    }

    /// Takes a row into account.
    pub fn record(&mut self, now: &BodyRow) -> Result<(), RunError> {
        self.see(now);
        self.watch.observe(now)
    }

    fn see(&mut self, now: &BodyRow) {
        self.peak_strain_energy = self.peak_strain_energy.max(now.strain_energy);
        Largest::watch(&mut self.peak_stress, self.of.model, now);
    }

    /// What is told of it when it has come to its end, with the last row; and warnings.
    pub fn report(mut self, last: &BodyRow) -> (BodyRunReport, Vec<String>) {
        let stats = self.simulation.stats();
        let Watched { balances, right_unsummed, left_out, turned, warnings } = self.watch.finish(&self.simulation);
        let RunBody { scene, model } = self.of;
        let report = BodyRunReport {
            name: self.of.name().to_owned(),
            steps: stats.accepted,
            rejected_steps: stats.rejected,
            step_lengths: [stats.shortest, stats.longest],
            evaluations: stats.evaluations,
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
        };
        (report, warnings)
    }
}

/// Reads a row back as far as the review, the monitor and the stress look at it.
fn restore(results: BodyResults<'_>, row: usize, time: f64, out: &mut BodyRow) -> Option<Conserved> {
    let number = |path| results.numbers(path)?.get(row).copied();
    let vector = |path| results.vectors(path)?.get(row).copied().map(Vector3::from);
    let modal = |path| results.table(path)?.row(row);
    let out = &mut out.motion;
    out.time = time;
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
