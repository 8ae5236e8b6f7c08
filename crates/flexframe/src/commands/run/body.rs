//! One body of a run: what is seen of it on its way, whatever moves it.

use dynamics::{Initial, Moment, MotionState, RunEnergies, Stats};
use model::Model;
use nalgebra::Vector3;
use results::BodyResults;
use rigid_kin::Attitude;
use scene::Body;

use super::balances::{Conserved, Monitor};
use super::body_report::BodyRunReport;
use super::error::RunError;
use super::watch::{Watch, Watched};
use crate::report::{BodyReport, MeshReport};
use crate::rows::effects;
use crate::rows::peak_stress::Largest;
use crate::rows::row::BodyRow;

/// A body that is to run, and its model.
#[derive(Debug, Clone, Copy)]
pub struct RunBody<'a> {
    /// The body of the scene.
    pub body: &'a Body,
    /// Its model.
    pub model: &'a Model,
}

impl RunBody<'_> {
    /// Name of the body, which is `body` where the scene gives none.
    pub fn name(&self) -> &str {
        name(self.body)
    }
}

/// Name of a body.
pub(super) fn name(body: &Body) -> &str {
    body.name.as_deref().unwrap_or("body")
}

/// A body on its way.
pub(super) struct FollowedBody<'a> {
    pub of: RunBody<'a>,
    /// Its number in the scene.
    pub number: usize,
    watch: Watch<'a>,
    peak_strain_energy: f64,
    peak_stress: Option<Largest>,
    first_attitude: Attitude,
    /// Centre of mass of the undeformed body at the start, global.
    first_center: Vector3<f64>,
}

impl<'a> FollowedBody<'a> {
    pub fn new(of: RunBody<'a>, number: usize, initial: &'a Initial) -> Result<Self, RunError> {
        let RunBody { body, model } = of;
        let (origin, center) = (model.body.origin, model.body.center_of_mass);
        let first_center = initial.origin.unwrap_or(origin) + initial.attitude.to_global(&(center - origin));
        Ok(Self {
            of,
            number,
            watch: Watch::new(body, model, initial, model.physics.effects)?,
            peak_strain_energy: 0.0,
            peak_stress: None,
            first_attitude: initial.attitude,
            first_center,
        })
    }

    /// The monitor of what exact motion conserves.
    pub fn monitor_mut(&mut self) -> &mut Monitor {
        self.watch.monitor_mut()
    }

    /// Sees a moment between rows.
    pub fn look(&mut self, moment: &Moment) {
        self.watch.look(moment);
    }

    /// Sees how far the body would have bent after a step from a state.
    pub fn look_ahead(&mut self, state: &MotionState, step: f64) {
        self.watch.look_ahead(state, step);
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

    /// Refusal to go on, and since when, where the review has found that the model is wrong, unless the scene wants to.
    pub fn refusal(&self) -> Option<(f64, advice::Refusal)> {
        self.watch.refusal()
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

    /// Its report when it has come to its end, with the last row, the cost of its motion, its energies, and its
    /// scheme; and warnings.
    pub fn report(
        mut self,
        last: &BodyRow,
        (stats, energies, scheme): (&Stats, &RunEnergies, &str),
    ) -> (BodyRunReport, Vec<String>) {
        let Watched { balances, right_unsummed, energy_tells, step_error, turned, warnings } =
            self.watch.finish(energies, stats.longest);
        let RunBody { body, model } = self.of;
        let report = BodyRunReport {
            name: self.of.name().to_owned(),
            scheme: scheme.to_owned(),
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
            energy_tells,
            step_error: stats.error.map_or(step_error, |stated| Some(stated.sum)),
            forgotten_vibration: stats.error.map_or(0.0, |stated| stated.forgotten),
            effects: effects::computed(body, model),
            large_modes: model.large_modes().iter().map(|k| k + 1).collect(),
            static_answer: model.static_answer().map(|k| k + 1),
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
        kinetic: out.kinetic_energy,
    })
}
