//! A run: a body, a method, the steps that lead through it, and the times at which it is observed.

pub(crate) mod account;
pub(crate) mod builder;
pub mod checkpoint;
pub(crate) mod events;
pub(crate) mod fingerprint;
pub(crate) mod last_step;
pub(crate) mod longest_step;
pub(crate) mod plan;
pub(crate) mod setup;
pub(crate) mod stats;

use std::sync::{Arc, Mutex};

use serde::{Deserialize, Serialize};

use crate::body::motion_state::MotionState;
use crate::body::shapes::PointShapes;
use crate::error::{SetupError, StepError};
use crate::motion::{ErrorEstimate, Motion};
use crate::observation::Observation;
use crate::observation::moment::Moment;
use crate::observation::observer::{Observer, StepEnd};
use crate::observation::observers::Observers;
use crate::simulation::account::EnergyAccount;
use crate::simulation::checkpoint::{
    CheckpointError, counts, decode, encode, equal_room, expect, from_words, to_words,
};
use crate::simulation::events::{Event, Events};
use crate::simulation::fingerprint::Fingerprint;
use crate::simulation::last_step::LastStep;
use crate::simulation::longest_step::LongestStep;
use crate::simulation::plan::{EqualSteps, HalvedSteps, Plan, Progress, Rows, Segment, StepControl};
use crate::simulation::setup::{Beginning, Setup};
use crate::simulation::stats::Stats;
use crate::tolerance::allowance::Allowance;
use crate::tolerance::{ErrorKinds, ErrorMeasure};

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

/// A run in progress. As an iterator it yields the motion at each row; see [`Rows`].
#[derive(Debug, Clone)]
pub struct Simulation {
    fingerprint: Fingerprint,
    motion: Box<dyn Motion>,
    longest_step: LongestStep,
    plan: Plan,
    walk: Walk,
    rows: Rows,
    end: f64,
    steps_since_row: u64,
    phase: Phase,
    points: Vec<PointShapes>,
    stats: Stats,
    events: Events,
    /// Kept where events or times between steps are asked for.
    last_step: Option<LastStep>,
    /// Where events look at the motion.
    looked_at: Observation,
    account: EnergyAccount,
    observers: Observers<Observation>,
    /// True if steps may be blind to work of the loads, whose energy scale is then known.
    may_miss_work: bool,
}

/// The next thing that a run gives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
enum Phase {
    /// The row at the start, for who takes rows one by one; no step has been tried.
    Start,
    /// Steps.
    Steps,
    /// The row that falls on the event or the stop that has been reached.
    Row,
    /// Nothing, for who takes rows one by one: one of them has failed.
    Failed,
}

/// The way through the present segment.
#[derive(Debug, Clone, Serialize, Deserialize)]
enum Walk {
    Equal {
        step: f64,
        #[serde(with = "equal_room")]
        steps: Option<EqualSteps>,
    },
    Halved {
        measure: ErrorMeasure,
        longest_try: f64,
        #[serde(with = "equal_room")]
        steps: Option<HalvedSteps>,
    },
}

impl Walk {
    /// The segment, if there is one, and whether all its steps are done.
    fn segment(&self) -> Option<(&Segment, bool)> {
        match self {
            Self::Equal { steps, .. } => steps.as_ref().map(|steps| (&steps.segment, steps.is_done())),
            Self::Halved { steps, .. } => steps.as_ref().map(|steps| (&steps.segment, steps.next_step().is_none())),
        }
    }

    /// True at the end of a segment that a rule holds for.
    fn is_at_end(&self, of: impl Fn(&Segment) -> bool) -> bool {
        self.segment().is_some_and(|(segment, is_done)| is_done && of(segment))
    }

    /// Refuses what a run of this one cannot leave.
    fn check_saved(&self, saved: &Self) -> Result<(), CheckpointError> {
        match (self, saved) {
            (Self::Equal { step, .. }, Self::Equal { step: found, steps }) => {
                expect("the step", step == found)?;
                steps.iter().try_for_each(EqualSteps::check)
            }
            (Self::Halved { measure, .. }, Self::Halved { measure: found, longest_try, steps }) => {
                measure.check_saved(found)?;
                expect("the longest step to try", *longest_try > 0.0)?;
                steps.iter().try_for_each(HalvedSteps::check)
            }
            _ => expect("the kind of step control", false),
        }
    }
}

/// State of a run in a checkpoint.
#[derive(Serialize, Deserialize)]
struct Saved {
    motion: Vec<u8>,
    plan: Progress,
    walk: Walk,
    #[serde(with = "postcard::fixint::le")]
    steps_since_row: u64,
    phase: Phase,
    account: EnergyAccount,
    stats: Stats,
}

impl Simulation {
    /// Begins a run.
    ///
    /// # Errors
    /// [`SetupError`]: lists of the wrong length, numbers out of range, a step beyond the limit of the method, a
    /// tolerance for a method without an error estimate.
    pub fn new(setup: &Setup) -> Result<Self, SetupError> {
        setup.check()?;
        let Beginning { motion, energy_of_loads } = setup.method.begin(setup)?;
        setup.check_times()?;
        Self::begin(motion, energy_of_loads, setup)
    }

    fn begin(motion: Box<dyn Motion>, energy_of_loads: f64, setup: &Setup) -> Result<Self, SetupError> {
        let walk = match setup.control {
            StepControl::Fixed(step) => Walk::Equal { step, steps: None },
            StepControl::Tolerance(tolerance) => {
                let measure = ErrorMeasure::new(tolerance, setup.end, f64::EPSILON);
                Walk::Halved { measure, longest_try: f64::INFINITY, steps: None }
            }
        };
        let drive = setup.physics.drive.as_ref().map(|drive| &drive.speed.history);
        let longest_step = LongestStep::new(setup.loads, drive, setup.end)?;
        let looked_at = Observation::new(motion.flexible(), setup.points.len());
        Ok(Self {
            fingerprint: Fingerprint::of(setup),
            account: EnergyAccount::new(motion.energies(), energy_of_loads).of_scale(setup.energy_of_reference()),
            may_miss_work: setup.may_miss_work(motion.fastest_rate()),
            motion,
            events: Events::default(),
            last_step: None,
            looked_at,
            observers: Observers::NONE,
            plan: Plan::new(setup.end, longest_step.discontinuities(), setup.rows),
            longest_step,
            walk,
            rows: setup.rows,
            end: setup.end,
            steps_since_row: 0,
            phase: Phase::Start,
            points: setup.points.to_vec(),
            stats: Stats::NONE,
        })
    }

    /// Time that has been reached.
    pub fn time(&self) -> f64 {
        self.motion.time()
    }

    /// The state that has been reached.
    ///
    /// # Errors
    /// [`StepError`] where the inertia of the deformed body is singular.
    pub fn state(&self) -> Result<MotionState, StepError> {
        self.motion.state()
    }

    /// Goes on from another state, at its time. Work, impulses and balances are counted from there.
    ///
    /// # Errors
    /// [`SetupError`] for lists of the wrong length and numbers that are not finite.
    pub fn set_state(&mut self, state: &MotionState) -> Result<(), SetupError> {
        let stays = self.plan.are_same(state.time, self.time());
        self.motion.set_state(state)?;
        if self.phase == Phase::Row && !stays {
            self.phase = Phase::Steps;
        }
        let Self { motion, account, .. } = self;
        *account = EnergyAccount::new(motion.energies(), account.of_loads()).of_scale(account.least_scale());
        self.events.forget();
        self.go_on_from_here();
        Ok(())
    }

    /// Ends a step at this time and stops there with [`Reached::Stop`], once; an event or an error there comes in its place.
    /// `None` takes it back.
    pub fn set_stop_time(&mut self, time: Option<f64>) {
        self.plan.set_stop(time);
        self.go_on_from_here();
    }

    /// Call this after a [`Signal`](crate::Signal), or anything that a load of one's own reads, was changed since the last
    /// step: the next step then starts from the loads as they are, and has its full order. It allocates.
    pub fn loads_have_changed(&mut self) {
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
        self.motion.observe(&self.points, &mut self.looked_at)?;
        let number = self.events.add(event, &self.looked_at)?;
        self.keep_last_step();
        Ok(number)
    }

    /// An event by its number.
    pub fn event(&self, number: usize) -> Option<&Event> {
        self.events.get(number)
    }

    /// Shows every step's end to an observer.
    pub fn watch(&mut self, observer: Arc<Mutex<dyn Observer>>) {
        self.observers.add(observer);
    }

    /// Keeps the start of each step from now on, for [`Self::interpolate`].
    pub fn keep_last_step(&mut self) {
        if self.last_step.is_none() {
            self.last_step = Some(LastStep::new(&*self.motion, self.points.len()));
        }
    }

    /// Fills `out` with the motion at a time inside the last step, as accurately as the scheme steps. Needs
    /// [`Self::keep_last_step`].
    ///
    /// # Errors
    /// [`StepError::OutsideLastStep`], and what [`Self::observe`] finds.
    pub fn interpolate(&mut self, time: f64, out: &mut Observation) -> Result<(), StepError> {
        let now = self.time();
        let [from, to] = self.last_step.as_ref().map_or([now, now], LastStep::span);
        if time == now {
            return self.motion.observe(&self.points, out);
        }
        match &mut self.last_step {
            Some(step) if (from..=to.min(now)).contains(&time) => {
                out.clone_from(step.at(time, &self.points)?);
                Ok(())
            }
            _ => Err(StepError::OutsideLastStep { time, from, to: now }),
        }
    }

    /// The steps to come start at the time that has been reached, wherever the plan was.
    fn go_on_from_here(&mut self) {
        self.plan.go_to(self.motion.time());
        match &mut self.walk {
            Walk::Equal { steps, .. } => *steps = None,
            Walk::Halved { steps, .. } => *steps = None,
        }
    }

    /// Goes back to the first event in a step, and shows the step's end, which may be there, to the observers.
    fn look_at_step(&mut self) -> Result<Option<usize>, StepError> {
        let passed = self.go_to_event()?;
        let Self { motion, events, looked_at, points, account, observers, stats, .. } = self;
        account.exchange(motion.work_and_dissipation());
        account.check_motion(&**motion, stats.longest)?;
        observers.step(&mut StepEnd {
            motion: &mut **motion,
            points,
            longest_step: stats.longest,
            observation: looked_at,
            is_observed: !events.is_empty(),
        })?;
        Ok(passed)
    }

    /// Finds the first event in a step, and goes back there. Where there are events, the motion is then observed.
    fn go_to_event(&mut self) -> Result<Option<usize>, StepError> {
        let Self { motion, events, last_step, looked_at, points, plan, .. } = self;
        let Some(step) = last_step.as_mut().filter(|_| !events.is_empty()) else { return Ok(None) };
        motion.observe(points, looked_at)?;
        let passed = events.first_passed(&mut step.with_points(points), looked_at, plan.same())?;
        let Some(passed) = passed else { return Ok(None) };
        // At the end the motion is there already, and beyond the discontinuity that may be there.
        if !passed.at_end {
            motion.copy_state(step.probe());
            self.go_on_from_here();
            self.motion.observe(&self.points, &mut self.looked_at)?;
        }
        Ok(Some(passed.number))
    }

    /// True if a row falls on the event or the stop that has been reached, and comes next.
    pub fn row_is_due(&self) -> bool {
        self.phase == Phase::Row
    }

    /// True if neither a step nor a row is to come.
    pub fn is_over(&self) -> bool {
        self.phase != Phase::Row && self.plan.is_over(self.time())
    }

    /// Time at which the run ends.
    pub fn end(&self) -> f64 {
        self.end
    }

    /// Room for the motion of the body.
    pub fn room(&self) -> Observation {
        Observation::new(self.motion.flexible(), self.points.len())
    }

    /// The motion at the time that has been reached. [`Self::observe`] does the same without allocating.
    ///
    /// # Errors
    /// As [`Self::observe`].
    pub fn observation(&mut self) -> Result<Observation, StepError> {
        let mut out = self.room();
        self.observe(&mut out)?;
        Ok(out)
    }

    /// Fills `out` with the motion at the time that has been reached.
    ///
    /// # Errors
    /// [`StepError`] where the inertia of the deformed body is singular, and where the energy is not finite, or is not
    /// what the start, the loads and the damping account for.
    pub fn observe(&mut self, out: &mut Observation) -> Result<(), StepError> {
        self.motion.observe(&self.points, out)?;
        if !out.is_finite() {
            return Err(StepError::NotFinite { time: out.time, what: "a quantity of the motion" });
        }
        self.account.check_motion(&*self.motion, self.stats.longest)?;
        self.observers.observed(&mut StepEnd {
            motion: &mut *self.motion,
            points: &self.points,
            longest_step: self.stats.longest,
            observation: out,
            is_observed: true,
        })
    }

    /// Sum of |work of the loads| + |dissipation| of all steps so far: how much energy has come and gone; or the energy that a bent rest
    /// which nothing holds sets free, if that is more.
    pub fn exchanged(&self) -> f64 {
        self.account.exchanged().max(self.account.least_scale())
    }

    /// The state that has been reached, as words; they are equally many for all states of a run.
    ///
    /// # Errors
    /// [`CheckpointError::Encoding`], from a scheme of one's own.
    pub fn checkpoint(&self) -> Result<Vec<u64>, CheckpointError> {
        let saved = Saved {
            motion: self.motion.save()?,
            plan: self.plan.progress(),
            walk: self.walk.clone(),
            steps_since_row: self.steps_since_row,
            phase: self.phase,
            account: self.account,
            stats: self.stats,
        };
        Ok(to_words(&encode(&(&self.fingerprint, encode(&saved)?))?))
    }

    /// Takes up the state of a [`Self::checkpoint`] of a run with the same set-up: what follows is what would have
    /// followed there, bit for bit.
    ///
    /// # Errors
    /// [`CheckpointError`] for a checkpoint of another run, with what differs: the body, the damping, a load, ... Of a load
    /// from a closure only its name, discontinuities and longest step are compared, and of a scheme of one's own what it checks.
    pub fn restored(mut self, checkpoint: &[u64]) -> Result<Self, CheckpointError> {
        let (fingerprint, saved): (Fingerprint, Vec<u8>) = from_words(checkpoint)?;
        self.fingerprint.check(&fingerprint)?;
        let saved: Saved = decode(&saved)?;
        counts(&[saved.steps_since_row])?;
        saved.stats.check()?;
        saved.account.check_saved()?;
        self.walk.check_saved(&saved.walk)?;
        self.motion.restore(&saved.motion)?;
        self.plan.set_progress(&saved.plan)?;
        (self.walk, self.account, self.stats) = (saved.walk, saved.account, saved.stats);
        (self.phase, self.steps_since_row) = (saved.phase, saved.steps_since_row);
        Ok(self)
    }

    /// Cost of the run so far.
    pub fn stats(&self) -> Stats {
        let error = match &self.walk {
            Walk::Halved { measure, .. } => Some(measure.stated()),
            Walk::Equal { .. } => None,
        };
        Stats { evaluations: self.motion.evaluations(), error, ..self.stats }
    }

    /// Goes on to the next row, event or stop, or as far as `max_steps` tries lead. Where a row falls on an event or the stop
    /// time, it comes next, without a step. Allocates nothing once each length of step has
    /// occurred.
    ///
    /// # Errors
    /// [`StepError`]; the motion stays where it was before the step that failed, or at the end of the step where its energy was
    /// found wrong, or the function of an event or an observer failed. A row that is due there comes next.
    pub fn advance(&mut self, max_steps: u64) -> Result<Reached, StepError> {
        self.advance_watched(max_steps, |_| ())
    }

    /// As [`Self::advance`]; `watch` sees the motion once for each step that is taken, rows or not.
    ///
    /// # Errors
    /// As [`Self::advance`].
    pub fn advance_watched(&mut self, max_steps: u64, mut watch: impl FnMut(&Moment)) -> Result<Reached, StepError> {
        if std::mem::replace(&mut self.phase, Phase::Steps) == Phase::Row {
            return Ok(Reached::Row);
        }
        if self.events.is_stale() {
            self.motion.observe(&self.points, &mut self.looked_at)?;
            self.events.reset(&self.looked_at)?;
        }
        for _ in 0..max_steps {
            match self.next_step() {
                None => return Ok(Reached::End),
                Some((h, end)) => {
                    if !self.try_step(h, end)? {
                        continue;
                    }
                    watch(&self.motion.moment());
                    if self.walk.is_at_end(|segment| segment.discontinuity) {
                        self.motion.pass_discontinuity()?;
                    }
                    // Under step control, steps are tried in pairs.
                    let (count, length) = if self.is_controlled() { (2, 0.5 * h) } else { (1, h) };
                    self.stats.take(count, length);
                    self.steps_since_row += count;
                    let ends_at_row = self.walk.is_at_end(|segment| segment.row);
                    let event = self.look_at_step();
                    // An event may have cut the step short; where one has failed, the step is done all the same.
                    let is_row = match self.rows {
                        Rows::EverySteps(steps) => self.steps_since_row >= steps || self.plan.is_over(self.time()),
                        Rows::Interval(_) => ends_at_row && self.plan.are_same(self.time(), end),
                    };
                    if is_row {
                        (self.phase, self.steps_since_row) = (Phase::Row, 0);
                    }
                    let stopped = self.plan.take_stop(self.time());
                    if let Some(number) = event? {
                        return Ok(Reached::Event(number));
                    }
                    if stopped {
                        return Ok(Reached::Stop);
                    }
                    if is_row {
                        self.phase = Phase::Steps;
                        return Ok(Reached::Row);
                    }
                }
            }
        }
        Ok(Reached::Between)
    }

    /// Length and end of the next step; `None` at the end.
    fn next_step(&mut self) -> Option<(f64, f64)> {
        loop {
            let next = match &mut self.walk {
                Walk::Equal { steps: Some(steps), .. } => steps.next_step(),
                Walk::Halved { steps: Some(steps), .. } => steps.next_step(),
                _ => None,
            };
            if next.is_some() {
                return next;
            }
            let segment = self.plan.next_segment()?;
            let longest = self.longest_step.in_segment(&segment);
            match &mut self.walk {
                Walk::Equal { step, steps } => {
                    *steps = Some(EqualSteps::new(segment, step.min(longest)));
                }
                Walk::Halved { longest_try, steps, .. } => {
                    *steps = Some(HalvedSteps::new(segment, *longest_try, longest));
                }
            }
        }
    }

    fn is_controlled(&self) -> bool {
        matches!(self.walk, Walk::Halved { .. })
    }

    /// Does a step; under step control, `false` where it was rejected.
    fn try_step(&mut self, h: f64, end: f64) -> Result<bool, StepError> {
        let time = self.time();
        let halved = self.is_controlled();
        if let Some(step) = &mut self.last_step {
            step.begin(&*self.motion, end, halved);
        }
        match &mut self.walk {
            Walk::Halved { measure, longest_try, steps: Some(steps) } => {
                let allowed = measure.allowed(h);
                let estimate = match self.motion.controlled_step(h, end, allowed) {
                    Ok(estimate) => estimate,
                    Err(error @ StepError::NoErrorEstimate { .. }) => return Err(error),
                    // A step so long that it cannot even be tried.
                    Err(_) => ErrorEstimate { step: f64::INFINITY, doubled: f64::INFINITY },
                };
                if estimate.step <= allowed {
                    measure.taken(end, &ErrorKinds { place: estimate.step, ..ErrorKinds::default() }, 0.0);
                    steps.accept(Allowance::may_double(&estimate, allowed));
                    // A step that only the segment's end made short says nothing about the next segment.
                    *longest_try = longest_try.max(steps.length());
                    return Ok(true);
                }
                self.stats.rejected += 2;
                measure.refused(time, end);
                if steps.reject(estimate.step / allowed) {
                    *longest_try = steps.length();
                    Ok(false)
                } else {
                    Err(StepError::Tolerance { time, step: h, tolerance: measure.tolerance })
                }
            }
            _ => self.motion.step(h, end).map(|()| true),
        }
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
            Phase::Steps | Phase::Row => loop {
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
