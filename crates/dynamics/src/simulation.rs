//! A run of the bodies of an island: the steps that lead through it, and the times at which it is observed.

pub(crate) mod account;
mod advance;
pub(crate) mod begun;
pub(crate) mod builder;
pub mod checkpoint;
pub(crate) mod due;
pub(crate) mod events;
pub(crate) mod fingerprint;
pub(crate) mod last_step;
pub(crate) mod longest_step;
pub(crate) mod plan;
mod saved;
pub(crate) mod setup;
pub(crate) mod stats;
pub(crate) mod walk;

use std::any::Any;
use std::sync::{Arc, Mutex};

use serde::{Deserialize, Serialize};

use crate::body::motion_state::MotionState;
use crate::body::shapes::PointShapes;
use crate::error::{SetupError, StepError};
use crate::motion::Motion;
use crate::motion::facts::MotionFacts;
use crate::observation::Observation;
use crate::observation::energies::{Energies, RunEnergies};
use crate::observation::observer::{Observer, StepEnd};
use crate::observation::observers::Observers;
use crate::observation::system::SystemObservation;
use crate::simulation::account::EnergyAccount;
use crate::simulation::begun::Begun;
use crate::simulation::due::Due;
use crate::simulation::events::{Event, Events};
use crate::simulation::fingerprint::Fingerprint;
use crate::simulation::last_step::{LastStep, Retaken};
use crate::simulation::longest_step::LongestStep;
use crate::simulation::plan::{Plan, Rows};
use crate::simulation::setup::{Beginning, Setup};
use crate::simulation::stats::Stats;
use crate::simulation::walk::Walk;
use crate::system::joint::observation::JointObservation;
use crate::system::radau::SystemMotion;
use crate::system::run::SystemRun;
use crate::system::run::setup::SystemSetup;

/// Where [`Simulation::advance`] has come to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Reached {
    /// An event, by its number in the order in which they were added.
    Event(usize),
    /// The stop time.
    Stop,
    /// A time at which the motion is to be observed.
    Row,
    /// Nothing yet, after as many steps as were allowed.
    Between,
    /// The end; the row there has been reached before.
    End,
}

/// A run in progress, of a body or of bodies in joints. Bodies, joints and force elements have numbers from 0. As an iterator it yields the
/// motion of the first body at each row; see [`Rows`].
#[derive(Debug, Clone)]
pub struct Simulation {
    fingerprint: Fingerprint,
    motion: Box<dyn Motion>,
    facts: MotionFacts,
    longest_step: LongestStep,
    plan: Plan,
    walk: Walk,
    rows: Rows,
    end: f64,
    steps_since_row: u64,
    due: Due,
    /// An event that is still to be told; the motion is there.
    pending_event: Option<usize>,
    phase: Phase,
    /// Points of each body that are observed.
    points: Vec<Vec<PointShapes>>,
    stats: Stats,
    events: Events,
    /// Kept where events, rows within steps or times between steps are asked for.
    last_step: Option<Box<LastStep>>,
    /// Where events and observers look at the motion.
    looked_at: SystemObservation,
    account: EnergyAccount,
    observers: Observers,
    /// True if steps may be blind to work of the loads, whose energy scale is then known.
    may_miss_work: bool,
}

/// The next thing that a run gives to those who take rows one by one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
enum Phase {
    /// The row at the start; no step has been tried.
    Start,
    /// Rows that steps lead to.
    Steps,
    /// Nothing: a row has failed.
    Failed,
}

impl Simulation {
    /// Begins the run of a body.
    ///
    /// # Errors
    /// [`SetupError`]: lists of the wrong length, numbers out of range, a step beyond the limit of the method, a
    /// tolerance for a method without an error estimate.
    pub fn new(setup: &Setup) -> Result<Self, SetupError> {
        setup.check()?;
        let Beginning { motion, energy_of_loads } = setup.method.begin(setup)?;
        setup.check_times()?;
        let drive = setup.physics.drive.as_ref().map(|drive| &drive.speed.history);
        Ok(Self::begin(Begun {
            fingerprint: Fingerprint::of(setup),
            account: EnergyAccount::new(motion.energies(), energy_of_loads).of_scale(setup.energy_of_reference()),
            may_miss_work: setup.may_miss_work(motion.facts().fastest_rate),
            motion,
            longest_step: LongestStep::new(setup.loads, drive, setup.end)?,
            jumps: Vec::new(),
            control: setup.control,
            end: setup.end,
            rows: setup.rows,
            points: vec![setup.points.to_vec()],
        }))
    }

    /// Puts bodies together, and begins their run.
    ///
    /// # Errors
    /// [`SetupError`]: numbers out of range, states that do not fit their bodies, and joints that cannot be closed.
    pub fn of_system(setup: SystemSetup) -> Result<Self, SetupError> {
        Ok(Self::begin(SystemRun::begin(setup)?))
    }

    fn begin(begun: Begun) -> Self {
        let Begun { motion, longest_step, control, end, rows, points, .. } = begun;
        let facts = motion.facts();
        // Rows do not end free steps.
        let ends = if facts.is_free() { Rows::EverySteps(1) } else { rows };
        let is_within = facts.is_free() && matches!(rows, Rows::Interval(_));
        Self {
            fingerprint: begun.fingerprint,
            account: begun.account,
            may_miss_work: begun.may_miss_work,
            events: Events::default(),
            last_step: is_within.then(|| Box::new(LastStep::new(&*motion, &facts, &points))),
            looked_at: SystemObservation::new(&facts, &points),
            observers: Observers::NONE,
            plan: Plan::new(end, longest_step.discontinuities().chain(begun.jumps), ends),
            walk: Walk::new(control, facts.stepping, [motion.time(), end]),
            longest_step,
            motion,
            facts,
            rows,
            end,
            steps_since_row: 0,
            due: Due::NOTHING,
            pending_event: None,
            phase: Phase::Start,
            points,
            stats: Stats::NONE,
        }
    }

    /// The motion at the time that has been reached.
    fn now(&self) -> &dyn Motion {
        match &self.last_step {
            Some(step) if self.due.within.is_some() => &*step.probe,
            _ => &*self.motion,
        }
    }

    /// Time that has been reached.
    pub fn time(&self) -> f64 {
        self.now().time()
    }

    /// Time at which the run ends.
    pub fn end(&self) -> f64 {
        self.end
    }

    /// How bodies in joints were put together, and how their steps went; `None` of a body that nothing ties.
    pub fn system(&self) -> Option<&SystemRun> {
        (&*self.motion as &dyn Any).downcast_ref()
    }

    /// The motion of bodies in joints at the time that has been reached.
    pub fn system_motion(&self) -> Option<&SystemMotion> {
        (self.now() as &dyn Any).downcast_ref().map(SystemRun::motion)
    }

    /// The state of each body that has been reached.
    ///
    /// # Errors
    /// [`StepError`] where the inertia of a deformed body is singular.
    pub fn states(&self) -> Result<Vec<MotionState>, StepError> {
        self.now().states()
    }

    /// Goes on from other states of the bodies, at the time of the first. Bodies are moved so that joints close. Work, impulses and
    /// balances are counted from there.
    ///
    /// # Errors
    /// [`SetupError`] for lists of the wrong length, numbers that are not finite, and joints that cannot be closed; the motion then
    /// stays.
    pub fn set_states(&mut self, states: &[MotionState]) -> Result<(), SetupError> {
        self.stay_here();
        let before = self.motion.time();
        self.motion.set_states(states)?;
        let Self { motion, account, last_step, .. } = self;
        *account = EnergyAccount::new(motion.energies(), account.of_loads()).of_scale(account.least_scale());
        last_step.iter_mut().for_each(|step| step.keep(&**motion));
        let time = motion.time();
        if !self.plan.are_same(time, before) {
            self.due = Due { rows: self.row_after(time), ..Due::NOTHING };
        }
        self.pending_event = None;
        self.events.forget();
        self.go_on_from_here();
        Ok(())
    }

    /// Ends a step at this time and stops there with [`Reached::Stop`], once; rows before it come first, and an event or an error there
    /// comes in its place. `None` takes it back.
    pub fn set_stop_time(&mut self, time: Option<f64>) {
        self.plan.set_stop(time);
        self.due.stop = false;
        self.go_on_from_here();
    }

    /// Call this after a [`Signal`](crate::Signal), or anything that a load of one's own reads, was changed: the motion goes on from the
    /// time that has been reached with the loads as they are, and the next step has its full order. It allocates.
    pub fn loads_have_changed(&mut self) {
        self.stay_here();
        self.motion.loads_have_changed();
        if self.may_miss_work {
            self.account.raise_of_loads(self.motion.raise_energy_of_loads(self.end));
        }
        self.events.forget();
    }

    /// Stops with [`Reached::Event`] where the event's function passes through zero, to rounding on the far side. The
    /// time is found by shorter steps, so it is as accurate as the scheme. Returns the event's number.
    ///
    /// # Errors
    /// [`StepError`] where the motion cannot be observed, and where the event's function gives no finite number.
    pub fn add_event(&mut self, event: Event) -> Result<usize, StepError> {
        self.stay_here();
        self.looked_at.find(&mut *self.motion, &self.points)?;
        let number = self.events.add(event, &self.looked_at)?;
        self.keep_last_step();
        Ok(number)
    }

    /// An event by its number.
    pub fn event(&self, number: usize) -> Option<&Event> {
        self.events.get(number)
    }

    /// Shows every step's end to an observer, and the motion at each row.
    pub fn watch(&mut self, observer: Arc<Mutex<dyn Observer>>) {
        self.observers.add(observer);
    }

    /// Keeps the start of each step from now on, for [`Self::interpolate`].
    pub fn keep_last_step(&mut self) {
        let Self { last_step, motion, facts, points, .. } = self;
        last_step.get_or_insert_with(|| Box::new(LastStep::new(&**motion, facts, points)));
    }

    /// Fills `out`, one for each body, with the motion at a time inside the last step, as accurately as the scheme steps. Needs
    /// [`Self::keep_last_step`].
    ///
    /// # Errors
    /// [`StepError::OutsideLastStep`], and what [`Self::observe`] finds.
    pub fn interpolate<'o>(
        &mut self,
        time: f64,
        out: impl IntoIterator<Item = &'o mut Observation>,
    ) -> Result<(), StepError> {
        let retaken = self.retaken();
        let Self { last_step, motion, facts, points, due, .. } = self;
        let now = motion.time();
        let from = last_step.as_ref().map_or(now, |step| step.before.time());
        let at = match last_step {
            _ if time == now => &mut **motion,
            Some(step) if (from..=now).contains(&time) => {
                if facts.is_free() {
                    step.interpolate(&**motion, time)?;
                } else {
                    step.go_to(time, retaken)?;
                }
                &mut *step.probe
            }
            _ => return Err(StepError::OutsideLastStep { time, from, to: now }),
        };
        at.begin_observation()?;
        for (body, (out, points)) in out.into_iter().zip(points).enumerate() {
            at.observe(body, points, out)?;
        }
        if let (Some(row), Some(step)) = (due.within, last_step) {
            step.interpolate(&**motion, row)?;
        }
        Ok(())
    }

    /// How parts of the last step are taken once more.
    fn retaken(&self) -> Retaken {
        Retaken { in_halves: self.walk.is_in_pairs(), exactness: self.walk.exactness(self.stats.shortest) }
    }

    /// Room for the motion of a body.
    pub fn room(&self, body: usize) -> Observation {
        Observation::new(self.facts.flexible[body], self.points[body].len())
    }

    /// The motion of the first body at the time that has been reached. [`Self::observe`] does the same without allocating.
    ///
    /// # Errors
    /// As [`Self::observe`].
    pub fn observation(&mut self) -> Result<Observation, StepError> {
        let mut bodies = self.system_observation()?.bodies;
        Ok(bodies.swap_remove(0))
    }

    /// The bodies, joints and force elements at the time that has been reached.
    ///
    /// # Errors
    /// As [`Self::observe`].
    pub fn system_observation(&mut self) -> Result<SystemObservation, StepError> {
        let mut out = SystemObservation::new(&self.facts, &self.points);
        self.observe(&mut out.bodies)?;
        out.find_ties(self.now());
        Ok(out)
    }

    /// Fills `out`, one for each body, with the motion at the time that has been reached.
    ///
    /// # Errors
    /// [`StepError`] where the inertia of a deformed body is singular, and where the energy is not finite, or is not what the
    /// start, the loads, the joints and the damping account for.
    pub fn observe<'o>(&mut self, out: impl IntoIterator<Item = &'o mut Observation>) -> Result<(), StepError> {
        let Self { last_step, motion, facts, points, due, account, stats, looked_at, observers, .. } = self;
        let motion = match last_step {
            Some(step) if due.within.is_some() => &mut *step.probe,
            _ => &mut **motion,
        };
        let (time, longest_step) = (motion.time(), stats.longest);
        motion.begin_observation()?;
        let mut sum = Energies { time, ..Energies::default() };
        for (body, (out, points)) in out.into_iter().zip(&*points).enumerate() {
            motion.observe(body, points, out)?;
            if !out.is_finite() {
                return Err(match motion.name_of(body) {
                    Some(body) => StepError::BodyNotFinite { time, body },
                    None => StepError::NotFinite { time, what: "a quantity of the motion" },
                });
            }
            sum.internal += out.energy();
            sum.work += out.work.work;
            sum.dissipation += out.work.dissipation;
        }
        if let Some(balance) = motion.balance(&sum, account.elapsed(time)) {
            account.check_row(&balance, facts.fastest_rate, longest_step)?;
        }
        observers.observed(&mut StepEnd { motion, points, longest_step, observation: looked_at, is_observed: false })
    }

    /// Observes a joint, after [`Self::observe`].
    pub fn observe_joint(&self, joint: usize) -> JointObservation {
        self.now().observe_joint(joint)
    }

    /// Observes a force element, after [`Self::observe`]; zeros of one that does not show what it does.
    pub fn observe_element(&self, element: usize) -> JointObservation {
        self.now().observe_element(element)
    }

    /// Energies of the run so far that the balances of a body are counted over.
    pub fn energies(&self, body: usize) -> RunEnergies {
        let account = &self.account;
        match self.motion.exchanged(body) {
            Some([exchanged, at_rest]) => {
                RunEnergies { exchanged, at_rest, open_together: Some(account.largest_open()) }
            }
            None => {
                let exchanged = account.exchanged().max(account.least_scale());
                RunEnergies { exchanged, at_rest: 0.0, open_together: None }
            }
        }
    }

    /// Cost of the run so far.
    pub fn stats(&self) -> Stats {
        Stats { evaluations: self.motion.evaluations(), error: self.walk.stated_error(), ..self.stats }
    }

    /// Steps tried so far.
    pub fn tried(&self) -> u64 {
        self.stats.accepted + self.stats.rejected
    }

    /// The tolerance that bounds the errors of the steps; none of fixed steps.
    pub fn tolerance(&self) -> Option<f64> {
        self.walk.tolerance()
    }

    /// True if rows are found within steps, which end where they like.
    pub(crate) fn is_free(&self) -> bool {
        self.facts.is_free()
    }
}

impl Iterator for Simulation {
    type Item = Result<Observation, StepError>;

    /// The motion at the next row, the first of which is the start where no step has been tried yet; `None` at the end
    /// and after an error.
    fn next(&mut self) -> Option<Self::Item> {
        let row = match self.phase {
            Phase::Failed => return None,
            Phase::Start => {
                self.phase = Phase::Steps;
                self.observation()
            }
            Phase::Steps => loop {
                match self.advance(u64::MAX) {
                    Ok(Reached::Between | Reached::Stop | Reached::Event(_)) => {}
                    Ok(Reached::End) => return None,
                    Ok(Reached::Row) => break self.observation(),
                    Err(error) => break Err(error),
                }
            },
        };
        if row.is_err() {
            self.phase = Phase::Failed;
        }
        Some(row)
    }
}
