//! Watch of a motion beside its rows: the assumptions of its model, and the quantities that should stay as they are.

use advice::{Refusal, Review, StepEstimate};
use dynamics::{EffectMap, Initial, Moment, MotionState, Observation, RunEnergies};
use model::{BuildError, Model};
use scene::{Body, Load, LoadKind, LoadPlace};

use super::balances::{Balances, Conserved, Monitor};
use super::error::RunError;
use super::turn::Turn;
use crate::plausible;

/// Energy balance from which on a run says that it is open.
const OPEN: f64 = 1e-2;

/// Estimated error from which on a run says that its steps are too long.
const WRONG: f64 = 1e-2;

/// Largest step times ω_max in which the stages see the work on the modes and their dissipation as they are.
const RESOLVED: f64 = 0.5;

/// Watches a motion. Every moment goes to [`Self::look`], every row to [`Self::observe`].
pub struct Watch<'a> {
    scene: &'a Body,
    model: &'a Model,
    review: Review<'a>,
    monitor: Monitor,
    turn: Turn,
    /// Expected error of fixed steps.
    step: Option<StepEstimate>,
}

/// Findings about a motion that has come to its end.
#[derive(Debug, Clone)]
pub struct Watched {
    /// How far the balances are from closed.
    pub balances: Balances,
    /// See `right_unsummed` of the report of a body.
    pub right_unsummed: bool,
    /// See `energy_tells` of the report of a body.
    pub energy_tells: bool,
    /// See `step_error` of the report of a body.
    pub step_error: Option<f64>,
    /// Angle along the way of the attitude, ∫|ω| dt, rad.
    pub turned: f64,
    /// Assumptions that did not hold, each a sentence or more.
    pub warnings: Vec<String>,
}

impl<'a> Watch<'a> {
    /// The watch of the motion of a scene that begins with `initial` and is computed with these effects.
    ///
    /// # Errors
    /// [`RunError::Setup`].
    pub fn new(
        body: &'a Body,
        model: &'a Model,
        initial: &'a Initial,
        effects: EffectMap<bool>,
    ) -> Result<Self, RunError> {
        let step = model
            .step_estimate(body)
            .map_err(|source| RunError::Setup { scene: body.path.clone(), source: Box::new(source) })?;
        Ok(Self {
            scene: body,
            model,
            review: Review::new(model.case(body, initial), effects, &model.advice),
            monitor: Monitor::default(),
            turn: Turn::default(),
            step,
        })
    }

    /// Sees a moment between rows.
    pub fn look(&mut self, moment: &Moment) {
        self.review.look(moment);
        self.turn.see(moment.time, &moment.omega_body);
    }

    /// Sees where a step from a state would lead by the rates that it begins with, as far as each mode can swing.
    pub fn look_ahead(&mut self, state: &MotionState, step: f64) {
        let MotionState { time, omega_body, modal_displacement: q, modal_velocity: v, .. } = state;
        let omega = &self.model.body.circular_frequencies;
        let swung = |((q, v), omega): ((&f64, &f64), &f64)| {
            let reach = q.hypot(v / omega);
            (q + step * v).clamp(-reach, reach)
        };
        let ahead: Vec<f64> = q.iter().zip(v).zip(omega).map(swung).collect();
        let (time, omega_body) = (time + step, *omega_body);
        self.review.look(&Moment { time, omega_body, modal_displacement: &ahead, modal_velocity: v });
    }

    /// Sees a row.
    ///
    /// # Errors
    /// [`RunError::Build`] where the assumptions cannot be checked.
    pub fn observe(&mut self, now: &Observation) -> Result<(), RunError> {
        self.monitor.watch(now);
        self.turn.see(now.time, &now.omega_body);
        self.review.observe(now).map_err(BuildError::from)?;
        Ok(())
    }

    /// Sees a row of a run that is taken up again.
    pub(super) fn take_up(&mut self, now: &Observation, past: &Conserved) -> Result<(), RunError> {
        self.review.observe(now).map_err(BuildError::from)?;
        self.monitor.take(past);
        self.turn.see(now.time, &now.omega_body);
        Ok(())
    }

    /// Reason to end the motion, and its time: the review has found that the model is wrong. Nothing where the scene
    /// wants to go on all the same.
    pub fn refusal(&self) -> Option<(f64, Refusal)> {
        self.review.stop().filter(|_| self.scene.effects.refuse)
    }

    /// The monitor of what exact motion conserves.
    pub(super) fn monitor_mut(&mut self) -> &mut Monitor {
        &mut self.monitor
    }

    /// Findings when the motion has come to its end, with these energies, in steps of at most this length.
    pub fn finish(&mut self, energies: &RunEnergies, longest_step: f64) -> Watched {
        let Self { scene, model, .. } = *self;
        let RunEnergies { exchanged, at_rest, open_together } = *energies;
        if scene.tied {
            let radius_squared = model.body.inertia_about_center().trace() / (2.0 * model.body.mass);
            self.monitor.in_joints(model.body.mass, radius_squared.sqrt(), at_rest);
        }
        self.monitor.exchanged(exchanged);
        let balances = self.monitor.balances();
        let is_right_unsummed = self.is_right_unsummed(longest_step);
        let right_unsummed = balances.energy > OPEN && is_right_unsummed;
        let together = open_together.map(|open| open / self.monitor.scales().of.energy);
        let passed = together.filter(|together| balances.energy > OPEN && *together <= OPEN);
        let open = (balances.energy > OPEN && !right_unsummed).then(|| match passed {
            Some(together) => passed_between(balances.energy, together),
            None => open_balance(balances.energy, model.body.flexible()),
        });
        let moments = right_unsummed.then(|| pointed_moments(scene)).flatten();
        let wrong = self.step.as_ref().filter(|step| step.largest() >= WRONG);
        Watched {
            balances,
            right_unsummed,
            // The equations of the paper do not keep the energy in any steps.
            energy_tells: scene.method().abilities.keeps_energy && !is_right_unsummed && passed.is_none(),
            step_error: self.step.as_ref().map(StepEstimate::largest),
            turned: self.turn.angle(),
            warnings: (plausible::doubts(scene, model).into_iter())
                .chain(self.review.broken().iter().map(ToString::to_string))
                .chain(wrong.map(|step| long_steps(step, scene.effects.tolerance)))
                .chain(open)
                .chain(moments)
                .collect(),
        }
    }

    /// True if the steps are known to be right though they are too long for the sum of work and dissipation.
    fn is_right_unsummed(&self, longest_step: f64) -> bool {
        if !self.scene.method().abilities.keeps_energy {
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
}

/// Moments at points of a mesh, which twist the element there alone: that excites shapes faster than any step.
fn pointed_moments(body: &Body) -> Option<String> {
    let is_pointed = |load: &Load| load.kind == LoadKind::Moment && matches!(load.place, LoadPlace::Point(_));
    let load = body.loads.iter().position(is_pointed).filter(|_| body.source.has_elements())?;
    Some(format!(
        "loads[{load}]: this moment has no `radius`, so that it twists the one element at its point, by an angle that depends on the \
         mesh. Most of its work goes into shapes that are faster than the steps, and the energy is not summed closely. Give it the \
         radius of the part that takes it, such as that of a shaft or a flange"
    ))
}

/// The works of joints on two bodies cancel, whatever they are.
fn passed_between(open: f64, together: f64) -> String {
    format!(
        "the energy balance is open by {open:.1e} of the energy that there was or that came and went, though it is closed to \
         {together:.1e} for all bodies together: the joints have passed more between the bodies than the stages of a step tell, as \
         where a linkage goes through a singular position, near which its reactions grow beyond all bounds. Do not rely on the \
         reactions there"
    )
}

fn open_balance(open: f64, flexible: usize) -> String {
    let (work, help) = match flexible {
        0 => ("the work of the loads", "shorter steps"),
        _ => ("the work on modes that are faster than the step", "shorter steps, or fewer modes,"),
    };
    format!(
        "the energy balance is open by {open:.1e} of the energy that there was or that came and went: {work} is summed \
         too coarsely, or the motion itself is; take {help} until it does not matter to the answer"
    )
}

fn long_steps(estimate: &StepEstimate, share: f64) -> String {
    format!("{} Take shorter steps, or `tolerance` instead of `step`", estimate.in_words(share))
}
