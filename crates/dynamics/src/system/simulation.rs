//! A run of bodies with joints: steps to discontinuities and stops, rows and events within them.

mod last_step;
mod locked;
pub(crate) mod observation;
mod saved;
pub(crate) mod second_order;
pub(crate) mod setup;
mod stops;

use std::sync::{Arc, Mutex};

use serde::{Deserialize, Serialize};

use crate::body::motion_state::MotionState;
use crate::body::shapes::PointShapes;
use crate::conservative::ConservativeBody;
use crate::equations::Equations;
use crate::error::{SetupError, StepError};
use crate::load::SharedLoad;
use crate::matrix::lists::larger;
use crate::observation::Observation;
use crate::observation::energies::Energies;
use crate::observation::moment::Moment;
use crate::observation::observer::{Observer, StepEnd};
use crate::observation::observers::Observers;
use crate::simulation::Reached;
use crate::simulation::account::EnergyAccount;
use crate::simulation::checkpoint::{equal_room, fixed_room};
use crate::simulation::events::{Event, Events};
use crate::simulation::longest_step::LongestStep;
use crate::simulation::plan::{EqualSteps, Plan, Rows, Segment, StepControl};
use crate::simulation::stats::Stats;
use crate::system::joint::observation::JointObservation;
use crate::system::radau::SystemMotion;
use crate::system::radau::estimate::energy_of_way;
use crate::system::simulation::last_step::{EXACT, LastStep, of_step};
use crate::system::simulation::observation::SystemObservation;
use crate::system::simulation::second_order::Branching;
use crate::system::simulation::setup::{Assembled, ShapeLimit, SystemSetup, assemble, size};
use crate::tolerance::ErrorMeasure;

/// First step that is tried under step control, as a part of the run.
const FIRST: f64 = 1e-3;
/// Longest step of an explicit scheme under step control, as a part of what the fastest shape allows.
const STABLE: f64 = 0.9;
/// Error of a fixed step over the size of a body that is taken for what it does not see.
const FIXED_ERROR: f64 = 1e-4;
/// Way of a body over the size of a body within which it rests in fixed steps.
const FIXED_REST: f64 = 1e-9;
/// Speed of what begins to move as t³, over its mean speed since then.
const BEGINS: f64 = 3.0;

/// A run of bodies with joints in progress. Its steps end where they like, and at discontinuities and stops: a row within a step is
/// that of the step's polynomials.
#[derive(Debug, Clone)]
pub struct SystemSimulation {
    motion: SystemMotion,
    plan: Plan,
    walk: Walk,
    control: StepControl,
    /// Under step control.
    measure: Option<ErrorMeasure>,
    rows: Rows,
    end: f64,
    steps_since_row: u64,
    longest_step: LongestStep,
    shape_limit: Option<ShapeLimit>,
    points: Vec<Vec<PointShapes>>,
    size: f64,
    /// Sum of the largest forces of the loads of each body.
    forces: f64,
    assembled: Vec<Assembled>,
    redundant: Vec<(String, usize)>,
    branching: Option<Branching>,
    /// The largest residual at the ends of steps, as a length over the size of the system.
    largest_residual: f64,
    /// The first time at which the rounding of places of the ground decides how a linkage goes on.
    undecided_at: Option<f64>,
    /// The largest rounding of places of bodies at the ends of steps, over the size of the largest body.
    rounding_of_places: f64,
    stats: Stats,
    account: EnergyAccount,
    /// Energy exchanged of each body, see [`Self::exchanged`].
    exchanged: Vec<f64>,
    /// See [`Self::open_energy`].
    open_energy: f64,
    /// Way of each body in its frame since the beginning, as it moves and turns.
    gone: Vec<f64>,
    events: Events<SystemObservation>,
    /// Where events and observers look at the motion.
    looked_at: SystemObservation,
    observers: Observers<SystemObservation>,
    /// Kept where there may be rows or events within steps.
    last_step: Option<Box<LastStep>>,
    due: Due,
    /// An event that is still to be told; the motion is there.
    pending_event: Option<usize>,
}

/// The way through the present segment.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct Walk {
    #[serde(with = "equal_room")]
    segment: Option<Segment>,
    /// Equal steps through it, where steps are fixed.
    equal: EqualSteps,
    /// Length of the next try under step control, before the segment limits it, and the longest in this segment.
    next: f64,
    longest: f64,
}

/// Rows and stops that have come with the last step.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct Due {
    /// The time of the row within the last step that has been reached.
    #[serde(with = "equal_room")]
    within: Option<f64>,
    /// Number of the next row at an interval.
    #[serde(with = "fixed_room")]
    rows: u64,
    /// True if the stop has been reached, and is still to be told.
    stop: bool,
    /// The same of a row after a number of steps.
    row: bool,
}

impl SystemSimulation {
    /// Puts the bodies together, and begins a run.
    ///
    /// # Errors
    /// [`SetupError`]: numbers out of range, states that do not fit their bodies, and joints that cannot be closed.
    pub fn new(setup: SystemSetup) -> Result<Self, SetupError> {
        setup.check()?;
        let shape_limit = setup.shape_limit();
        let SystemSetup { system, states, relaxed, scheme, control, end, rows, points } = setup;
        let mut motion = SystemMotion::new(system, &states)?.with_scheme(scheme);
        let size = size(&motion, &states);
        let (assembled, branching) = assemble(&mut motion, &states, relaxed, [size, end])?;
        let is_implied = motion.implied_rows();
        let implied = motion.system().connections.sums(is_implied.iter().map(|is_implied| usize::from(*is_implied)));
        let redundant = implied.into_iter().filter(|(_, rows)| *rows > 0).map(|(name, rows)| (name.to_owned(), rows));
        let redundant = redundant.collect();
        let system = motion.system();
        let loads: Vec<SharedLoad> = system.bodies().iter().flat_map(|body| body.loads()).cloned().collect();
        let longest_step = LongestStep::new(&loads, system.joints().iter().flat_map(|joint| joint.histories()), end)?;
        let force = |body: &ConservativeBody| (body.mass() * body.sizes_of_loads(end).acceleration).sqrt();
        let forces = system.bodies().iter().map(force).sum();
        let is_within = matches!(rows, Rows::Interval(_));
        Ok(Self {
            // Rows do not end steps.
            plan: Plan::new(
                end,
                longest_step.discontinuities().chain(system.connections.discontinuities()),
                Rows::EverySteps(1),
            ),
            walk: Walk { segment: None, equal: EqualSteps::default(), next: FIRST * end, longest: f64::INFINITY },
            exchanged: vec![0.0; system.bodies().len()],
            open_energy: 0.0,
            gone: vec![0.0; system.bodies().len()],
            looked_at: SystemObservation::new(system, &points),
            observers: Observers::NONE,
            last_step: is_within.then(|| Box::new(LastStep::new(&motion, &points))),
            measure: match control {
                StepControl::Fixed(_) => None,
                StepControl::Tolerance(tolerance) => Some(SystemMotion::measure(tolerance, end - motion.time())),
            },
            motion,
            control,
            rows,
            end,
            steps_since_row: 0,
            longest_step,
            shape_limit,
            points,
            size,
            forces,
            assembled,
            redundant,
            branching,
            largest_residual: 0.0,
            undecided_at: None,
            rounding_of_places: 0.0,
            stats: Stats::NONE,
            account: EnergyAccount::default(),
            events: Events::default(),
            due: Due::NOTHING,
            pending_event: None,
        })
    }

    /// Time that has been reached.
    pub fn time(&self) -> f64 {
        self.motion().time()
    }

    /// Time at which the run ends.
    pub fn end(&self) -> f64 {
        self.end
    }

    /// The motion at that time.
    pub fn motion(&self) -> &SystemMotion {
        match &self.last_step {
            Some(step) if self.due.within.is_some() => &step.probe,
            _ => &self.motion,
        }
    }

    /// True if neither a step nor a row is to come.
    pub fn is_over(&self) -> bool {
        let Due { within, stop, row, .. } = self.due;
        let is_told = !stop && !row && within.is_none() && self.pending_event.is_none();
        is_told && self.plan.is_over(self.motion.time()) && self.next_row().is_none()
    }

    /// Changes of each body by which the joints closed at the beginning.
    pub fn assembled(&self) -> &[Assembled] {
        &self.assembled
    }

    /// Largest distance of two bodies at the beginning, or the largest radius of gyration, if that is more.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// Names of the joints and couplings with rows that others imply where bodies are rigid, at the beginning, each with how many:
    /// what they bear is then not determined by rigid bodies, but by how the bodies give.
    pub fn redundant(&self) -> &[(String, usize)] {
        &self.redundant
    }

    /// The branches of the motion at the beginning, if there are two.
    pub fn branching(&self) -> Option<&Branching> {
        self.branching.as_ref()
    }

    /// The largest residual of all rows of joints and couplings at the ends of the steps so far, as a length over the size of the system.
    pub fn largest_residual(&self) -> f64 {
        self.largest_residual
    }

    /// The first time at which a linkage has passed so near a singular position that the rounding of places of the ground decides how it goes
    /// on.
    pub fn undecided_at(&self) -> Option<f64> {
        self.undecided_at
    }

    /// The largest rounding of places of bodies at the ends of the steps so far, over the size of the largest body: bodies that run far along
    /// a rail, from where a joint holds it to the ground, lose digits.
    pub fn rounding_of_places(&self) -> f64 {
        self.rounding_of_places
    }

    /// Degrees of freedom that the joints leave rigid bodies at the beginning.
    pub fn rigid_dofs(&self) -> usize {
        let system = self.motion.system();
        let implied: usize = self.redundant.iter().map(|(_, rows)| rows).sum();
        (system.rigid_coordinates() + implied).saturating_sub(system.rows())
    }

    /// Largest |work of loads, joints and elements| + |dissipation| since the beginning, of a body, or the largest energy of the motion, if that
    /// is more. Not their sum over the steps: what a spring gives and takes in each period would hide what is lost in all of them.
    pub fn exchanged(&self, body: usize) -> f64 {
        self.exchanged[body].max(self.motion.energy_scale())
    }

    /// Largest part of the energy of all bodies together for which their works and dissipation do not account, at the times that were observed.
    /// What joints pass from one to another has no part in it.
    pub fn open_energy(&self) -> f64 {
        self.open_energy
    }

    /// Energy below which a body rests: that of a motion in which its place changes by no more than it may be off in all of the run, and,
    /// of a rigid body that has gone no farther, the work of the loads over this way.
    pub fn energy_at_rest(&self, body: usize) -> f64 {
        let part = match self.control {
            StepControl::Fixed(_) => FIXED_REST,
            StepControl::Tolerance(tolerance) => tolerance,
        };
        let way = part * self.motion.size();
        let of = &self.motion.system().bodies()[body];
        let pushed = if of.flexible() == 0 && self.gone[body] <= way { self.forces * way } else { 0.0 };
        energy_of_way(of.mass(), way, self.end) + pushed
    }

    /// The limit that shapes set for the steps, if the scheme is one that they limit and steps have come near to it.
    pub fn met_shape_limit(&self) -> Option<ShapeLimit> {
        self.shape_limit.filter(|of| self.stats.longest > 0.9 * STABLE * of.limit)
    }

    /// Cost of the run so far.
    pub fn stats(&self) -> Stats {
        let error = self.measure.as_ref().map(ErrorMeasure::stated);
        Stats { evaluations: self.motion.evaluations(), error, ..self.stats }
    }

    /// The tolerance that bounds the errors of the steps; none of fixed steps.
    pub fn tolerance(&self) -> Option<f64> {
        self.measure.as_ref().map(|measure| measure.tolerance)
    }

    /// Room for the motion of a body.
    pub fn room(&self, body: usize) -> Observation {
        Observation::new(self.motion.system().bodies()[body].flexible(), self.points[body].len())
    }

    /// Energy of bodies that have moved by the error that is allowed since the beginning, a part of the size of the largest, and the work of
    /// their loads over it: what has moved less has work that steps do not see.
    fn unseen_energy(&self) -> f64 {
        let elapsed = self.account.elapsed(self.time());
        let part = match self.control {
            StepControl::Fixed(_) => FIXED_ERROR,
            StepControl::Tolerance(tolerance) => tolerance,
        };
        let mass: f64 = self.motion.system().bodies().iter().map(ConservativeBody::mass).sum();
        let way = part * self.motion.size();
        if elapsed > 0.0 { energy_of_way(mass, BEGINS * way, elapsed) + self.forces * way } else { 0.0 }
    }

    /// Fills `out`, one for each body, with the motion at the time that has been reached.
    ///
    /// # Errors
    /// [`StepError`] where the inertia of a deformed body is singular, and where the energy is not finite, or is not what the
    /// start, the loads, the joints and the damping account for.
    pub fn observe<'o>(&mut self, out: impl IntoIterator<Item = &'o mut Observation>) -> Result<(), StepError> {
        let (time, step) = (self.time(), self.stats.longest);
        let in_step = |error: crate::RateError| error.in_step(time, step);
        let unseen = self.unseen_energy();
        let motion = match &mut self.last_step {
            Some(step) if self.due.within.is_some() => &mut step.probe,
            _ => &mut self.motion,
        };
        motion.find_reactions().map_err(in_step)?;
        let mut sum = Energies { time, internal: 0.0, translation: 0.0, work: 0.0, dissipation: 0.0 };
        for (body, out) in out.into_iter().enumerate() {
            motion.observe(body, &self.points[body], out).map_err(in_step)?;
            if !out.is_finite() {
                return Err(StepError::BodyNotFinite { time, body: motion.system().named(body) });
            }
            sum.internal += out.energy();
            sum.work += out.work.work;
            sum.dissipation += out.work.dissipation;
        }
        self.account.raise_scale(motion.energy_scale());
        self.open_energy = larger(self.open_energy, self.account.open(&sum).abs());
        self.account.check_beyond(unseen, &sum, 0.0, step)?;
        let Self { points, looked_at, observers, .. } = self;
        observers.observed(&mut StepEnd {
            motion,
            points,
            longest_step: step,
            observation: looked_at,
            is_observed: false,
        })
    }

    /// The bodies and joints at the time that has been reached.
    ///
    /// # Errors
    /// As [`Self::observe`].
    pub fn observation(&mut self) -> Result<SystemObservation, StepError> {
        let mut out = SystemObservation::new(self.motion.system(), &self.points);
        self.observe(&mut out.bodies)?;
        out.time = self.time();
        for (joint, out) in out.joints.iter_mut().enumerate() {
            *out = self.observe_joint(joint);
        }
        for (element, out) in out.elements.iter_mut().enumerate() {
            *out = self.observe_element(element);
        }
        Ok(out)
    }

    /// Observes a joint, after [`Self::observe`].
    pub fn observe_joint(&self, joint: usize) -> JointObservation {
        self.motion().observe_joint(joint)
    }

    /// Observes a force element, after [`Self::observe`]; zeros of one that does not show what it does.
    pub fn observe_element(&self, element: usize) -> JointObservation {
        self.motion().observe_element(element)
    }

    /// Goes on from other states of the bodies, at the time of the first of them. They are moved so that the joints close. Works,
    /// impulses and balances are counted from there.
    ///
    /// # Errors
    /// [`SetupError`] for lists of the wrong length, numbers that are not finite, and joints that cannot be closed; the motion then
    /// stays.
    pub fn set_states(&mut self, states: &[MotionState]) -> Result<(), SetupError> {
        let mut motion = self.motion().clone();
        motion.set_states(states)?;
        (self.assembled, self.branching) = assemble(&mut motion, states, false, [self.size, self.end])?;
        let stays = self.plan.are_same(motion.time(), self.time());
        self.motion = motion;
        self.account = EnergyAccount::default();
        self.exchanged.fill(0.0);
        self.gone.fill(0.0);
        self.open_energy = 0.0;
        if let Some(step) = &mut self.last_step {
            step.keep(&self.motion);
        }
        if !stays {
            self.due = Due { rows: self.row_after(self.motion.time()), ..Due::NOTHING };
        }
        (self.due.within, self.pending_event) = (None, None);
        self.events.forget();
        self.go_on_from_here();
        Ok(())
    }

    /// Ends a step at this time and stops there with [`Reached::Stop`], once; rows and events before it come first. `None` takes it
    /// back.
    pub fn set_stop_time(&mut self, time: Option<f64>) {
        self.plan.set_stop(time);
        self.due.stop = false;
        self.go_on_from_here();
    }

    /// Call this after a [`Signal`](crate::Signal), or anything that a load of one's own reads, was changed: the motion goes on from
    /// the time that has been reached with the loads as they are.
    pub fn loads_have_changed(&mut self) {
        self.stay_here();
        self.motion.forget_last_step();
        self.events.forget();
    }

    /// Stops with [`Reached::Event`] where the event's function passes through zero, to rounding on the far side. The time is found
    /// by shorter steps, so it is as accurate as the scheme. Returns the event's number.
    ///
    /// # Errors
    /// [`StepError`] where the motion cannot be observed, and where the event's function gives no finite number.
    pub fn add_event(&mut self, event: Event<SystemObservation>) -> Result<usize, StepError> {
        self.stay_here();
        let (time, step) = (self.motion.time(), self.stats.longest);
        self.looked_at.fill(&mut self.motion, &self.points).map_err(|error| error.in_step(time, step))?;
        let number = self.events.add(event, &self.looked_at)?;
        self.last_step.get_or_insert_with(|| Box::new(LastStep::new(&self.motion, &self.points)));
        Ok(number)
    }

    /// An event by its number.
    pub fn event(&self, number: usize) -> Option<&Event<SystemObservation>> {
        self.events.get(number)
    }

    /// Shows every step's end to an observer, and the motion at each row.
    pub fn watch(&mut self, observer: Arc<Mutex<dyn Observer<SystemObservation>>>) {
        self.observers.add(observer);
    }

    /// Leaves what the last step has done beyond the row within it that has been reached.
    fn stay_here(&mut self) {
        if let (Some(_), Some(step)) = (self.due.within.take(), &mut self.last_step) {
            self.motion.copy_from(&step.probe);
            self.motion.forget_last_step();
            step.keep(&self.motion);
            (self.pending_event, self.due.stop) = (None, false);
            self.events.forget();
            self.go_on_from_here();
        }
    }

    /// The steps to come start at the time that the motion has reached, wherever the plan was.
    fn go_on_from_here(&mut self) {
        self.plan.go_to(self.motion.time());
        self.walk.segment = None;
    }

    /// Goes back to a time within the last step, to where a shorter step leads.
    fn go_back_to(&mut self, time: f64) -> Result<(), StepError> {
        let exactness = self.exactness();
        let Some(step) = &mut self.last_step else { return Ok(()) };
        step.go_to(time, exactness)?;
        self.motion.copy_from(&step.probe);
        step.end = time;
        self.go_on_from_here();
        Ok(())
    }

    /// Error that Newton's method may leave in steps that go again to a time within one.
    fn exactness(&self) -> f64 {
        self.measure.as_ref().map_or(EXACT, |measure| measure.exactness(self.stats.shortest.min(measure.span)))
    }

    /// Number of the first row at an interval after a time.
    fn row_after(&self, time: f64) -> u64 {
        match self.rows {
            Rows::Interval(interval) => ((time + self.plan.same()) / interval).floor().max(0.0) as u64 + 1,
            Rows::EverySteps(_) => 1,
        }
    }

    /// Time of the next row at an interval; `None` after the last, which is at the end.
    fn next_row(&self) -> Option<f64> {
        let Rows::Interval(interval) = self.rows else { return None };
        let time = |row: u64| row as f64 * interval;
        let (next, last) = (time(self.due.rows), time(self.due.rows - 1));
        if self.plan.is_over(next) { (!self.plan.is_over(last)).then_some(self.end) } else { Some(next) }
    }

    /// The next row or event within the step that has been done, or at its end.
    fn next_due(&mut self) -> Result<Option<Reached>, StepError> {
        let (now, same) = (self.motion.time(), self.plan.same());
        self.due.within = None;
        let row = self.next_row();
        if let (Some(time), Some(step)) = (row.filter(|row| *row < now - same), &mut self.last_step) {
            step.interpolate(&self.motion, time)?;
            (self.due.within, self.due.rows) = (Some(time), self.due.rows + 1);
            return Ok(Some(Reached::Row));
        }
        if let Some(event) = self.pending_event.take() {
            return Ok(Some(Reached::Event(event)));
        }
        if std::mem::take(&mut self.due.stop) {
            return Ok(Some(Reached::Stop));
        }
        let is_row = row.is_some_and(|row| row <= now + same);
        self.due.rows += u64::from(is_row);
        Ok((std::mem::take(&mut self.due.row) || is_row).then_some(Reached::Row))
    }

    /// Goes on to the next row, event or stop, or as far as `max_steps` tries lead.
    ///
    /// # Errors
    /// As [`Self::advance_watched`].
    pub fn advance(&mut self, max_steps: u64) -> Result<Reached, StepError> {
        self.advance_watched(max_steps, |_, _| ())
    }

    /// The same; `watch` sees the motion of each body once for each
    /// step that is taken, rows or not.
    ///
    /// # Errors
    /// [`StepError`]; the motion stays where it was before the step that failed, or at its end where the function of an event has
    /// failed.
    pub fn advance_watched(
        &mut self,
        max_steps: u64,
        mut watch: impl FnMut(usize, &Moment),
    ) -> Result<Reached, StepError> {
        self.stop_within_last_step()?;
        if let Some(reached) = self.next_due()? {
            return Ok(reached);
        }
        if self.events.is_stale() {
            let (time, step) = (self.motion.time(), self.stats.longest);
            self.looked_at.fill(&mut self.motion, &self.points).map_err(|error| error.in_step(time, step))?;
            self.events.reset(&self.looked_at)?;
        }
        for _ in 0..max_steps {
            let Some(segment) = self.segment() else { return Ok(Reached::End) };
            self.motion.follow_islands();
            if let Some(step) = &mut self.last_step {
                step.begin(&self.motion);
            }
            let Some(length) = self.try_step(&segment)? else { continue };
            if let Some(step) = &mut self.last_step {
                step.end = self.motion.time();
            }
            (0..self.exchanged.len()).for_each(|body| watch(body, &self.motion.moment(body)));
            if self.motion.time() >= segment.end {
                self.walk.segment = None;
                if segment.discontinuity {
                    let (time, longest) = (self.time(), self.stats.longest);
                    self.motion.pass_discontinuity().map_err(|error| error.in_step(time, longest))?;
                }
            }
            let event = self.go_to_event();
            self.count(length);
            if let Rows::EverySteps(steps) = self.rows
                && (self.steps_since_row >= steps || self.plan.is_over(self.motion.time()))
            {
                (self.due.row, self.steps_since_row) = (true, 0);
            }
            self.tell_stop();
            self.pending_event = event?;
            self.show_step()?;
            if let Some(reached) = self.next_due()? {
                return Ok(reached);
            }
        }
        Ok(Reached::Between)
    }

    /// Shows the end of the step, which may be at an event within it, to the observers.
    fn show_step(&mut self) -> Result<(), StepError> {
        let Self { motion, points, stats, looked_at, observers, .. } = self;
        let longest_step = stats.longest;
        observers.step(&mut StepEnd { motion, points, longest_step, observation: looked_at, is_observed: false })
    }

    /// Goes back to a stop that has been set within the step that has been done, beyond the row there that has been reached.
    fn stop_within_last_step(&mut self) -> Result<(), StepError> {
        let Some(stop) = self.plan.stop().filter(|stop| self.due.within.is_some_and(|row| row < *stop)) else {
            return Ok(());
        };
        if stop < self.motion.time() - self.plan.same() {
            self.go_back_to(stop)?;
            self.pending_event = None;
            self.events.forget();
        }
        self.tell_stop();
        Ok(())
    }

    /// Notes that the stop has been reached, if it has.
    fn tell_stop(&mut self) {
        self.due.stop |= self.plan.take_stop(self.motion.time());
    }

    /// Finds the first event in the step that has been done, and goes back there.
    fn go_to_event(&mut self) -> Result<Option<usize>, StepError> {
        if self.events.is_empty() {
            return Ok(None);
        }
        let (time, exactness) = (self.motion.time(), self.exactness());
        let Self { motion, events, last_step: Some(step), looked_at, points, plan, .. } = self else { return Ok(None) };
        looked_at.fill(motion, points).map_err(|error| error.in_step(time, time - step.before.time()))?;
        let passed = events.first_passed(&mut step.with_points(points, exactness), looked_at, plan.same())?;
        let Some(passed) = passed else { return Ok(None) };
        // At the end the motion is there already, and beyond the discontinuity that may be there.
        if !passed.at_end {
            self.motion.copy_from(&step.probe);
            step.end = self.motion.time();
            self.go_on_from_here();
        }
        Ok(Some(passed.number))
    }

    /// The segment that the next step is in; `None` at the end.
    fn segment(&mut self) -> Option<Segment> {
        if let Some(segment) = self.walk.segment {
            return Some(segment);
        }
        let segment = self.plan.next_segment()?;
        let longest = match (self.shape_limit, self.control) {
            (Some(ShapeLimit { limit, .. }), StepControl::Tolerance(_)) => STABLE * limit,
            _ => f64::INFINITY,
        };
        let longest = longest.min(self.longest_step.in_segment(&segment));
        if let StepControl::Fixed(step) = self.control {
            self.walk.equal = EqualSteps::new(segment, step.min(longest));
        }
        (self.walk.segment, self.walk.longest) = (Some(segment), longest);
        Some(segment)
    }

    /// Tries a step. Returns its length where it was taken.
    fn try_step(&mut self, segment: &Segment) -> Result<Option<f64>, StepError> {
        let Some(measure) = &mut self.measure else {
            let Some((h, end)) = self.walk.equal.next_step() else { return Ok(None) };
            let time = self.motion.time();
            let tried = self.motion.try_step(h, end, EXACT, f64::INFINITY);
            return tried.map(|_| Some(h)).map_err(|failed| self.motion.reason_or(of_step(failed, time, h)));
        };
        let mut h = self.walk.next.min(self.walk.longest);
        let taken = self.motion.try_towards(segment.end, measure, &mut h);
        let taken = taken.map_err(|error| self.motion.reason_or(error))?;
        // What only the segment made short says nothing about the next one.
        if taken.is_none() || h < self.walk.next {
            self.walk.next = h;
        } else {
            self.walk.next = self.walk.next.max(h);
        }
        if taken.is_none() {
            self.stats.rejected += 1;
        }
        Ok(taken)
    }

    /// Counts a step that was taken.
    fn count(&mut self, length: f64) {
        self.stats.take(1, length);
        self.largest_residual = larger(self.largest_residual, self.motion.residual_of_last_step());
        self.rounding_of_places = self.rounding_of_places.max(self.motion.rounding_of_places());
        if self.motion.is_undecided() {
            self.undecided_at.get_or_insert(self.motion.time());
        }
        self.steps_since_row += 1;
        let mut total = [0.0; 2];
        for (body, exchanged) in self.exchanged.iter_mut().enumerate() {
            let now = self.motion.work_and_dissipation(body);
            *exchanged = exchanged.max(now[0].abs() + now[1].abs());
            total = [total[0] + now[0], total[1] + now[1]];
            self.gone[body] += self.motion.way_of_last_step(body);
        }
        self.account.exchange(total);
    }
}

impl Due {
    /// Before the first step.
    const NOTHING: Self = Self { within: None, rows: 1, stop: false, row: false };
}
