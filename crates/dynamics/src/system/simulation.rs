//! A run of bodies with joints: steps to rows and discontinuities, observation, checkpoints.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::body::motion_state::MotionState;
use crate::body::shapes::PointShapes;
use crate::error::{SetupError, StepError};
use crate::history::History;
use crate::history::formula_steps::FormulaSteps;
use crate::history::positive;
use crate::observation::Observation;
use crate::observation::energies::Energies;
use crate::observation::moment::Moment;
use crate::simulation::account::EnergyAccount;
use crate::simulation::checkpoint::{CheckpointError, counts, decode, encode, equal_room, expect, finite};
use crate::simulation::checkpoint::{fixed_room, from_words, to_words};
use crate::simulation::plan::{EqualSteps, Plan, Progress, Rows, Segment, StepControl};
use crate::simulation::{Reached, Stats};
use crate::system::collocation::SystemScheme;
use crate::system::description::System;
use crate::system::joint::observation::JointObservation;
use crate::system::radau::{Failed, SystemMotion, Tried};
use crate::system::saved::SavedMotion;

/// Exactness of Newton's method in fixed steps, whose error nobody bounds.
const EXACT: f64 = 1e-10;
/// First step that is tried under step control, as a part of the run.
const FIRST: f64 = 1e-3;
/// Residuals of positions beyond this part of the size of the system are not closed.
const CLOSED: f64 = 1e-9;

/// Everything that a run of bodies with joints needs.
#[derive(Debug, Clone)]
pub struct SystemSetup {
    /// The bodies and the joints.
    pub system: System,
    /// The motion of each body at the beginning, as far as the joints let it be.
    pub states: Vec<MotionState>,
    /// True if the bodies begin deformed as the forces of their motion and their joints ask, so that nothing rings.
    pub relaxed: bool,
    /// How it is stepped.
    pub scheme: SystemScheme,
    /// How long the steps are. A tolerance is that of each step, relative to the size of the bodies.
    pub control: StepControl,
    /// When it ends.
    pub end: f64,
    /// When it is observed.
    pub rows: Rows,
    /// Points of each body whose motion is observed.
    pub points: Vec<Vec<PointShapes>>,
}

/// Change of a body by which the joints close at the beginning.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Assembled {
    /// Distance that its origin was moved by.
    pub moved: f64,
    /// Angle that it was turned by, rad.
    pub turned: f64,
    /// Change of the velocity of its origin.
    pub velocity: f64,
    /// Change of its angular velocity.
    pub angular_velocity: f64,
}

/// A run of bodies with joints in progress.
#[derive(Debug, Clone)]
pub struct SystemSimulation {
    motion: SystemMotion,
    plan: Plan,
    walk: Walk,
    control: StepControl,
    rows: Rows,
    end: f64,
    steps_since_row: u64,
    formula_steps: FormulaSteps,
    histories: Vec<History>,
    points: Vec<Vec<PointShapes>>,
    size: f64,
    assembled: Vec<Assembled>,
    redundant: Vec<(String, usize)>,
    stats: Stats,
    account: EnergyAccount,
    exchanged: Vec<Exchanged>,
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

/// Energy that has come and gone in a body.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
struct Exchanged {
    sum: f64,
    done: [f64; 2],
}

/// State of a run in a checkpoint.
#[derive(Serialize, Deserialize)]
struct Saved {
    motion: SavedMotion,
    plan: Progress,
    walk: Walk,
    #[serde(with = "fixed_room")]
    steps_since_row: u64,
    account: EnergyAccount,
    exchanged: Vec<Exchanged>,
    #[serde(with = "fixed_room")]
    accepted: u64,
    #[serde(with = "fixed_room")]
    rejected: u64,
    lengths: [f64; 2],
}

impl SystemSimulation {
    /// Puts the bodies together, and begins a run.
    ///
    /// # Errors
    /// [`SetupError`]: numbers out of range, states that do not fit their bodies, and joints that cannot be closed.
    pub fn new(setup: SystemSetup) -> Result<Self, SetupError> {
        let SystemSetup { system, states, relaxed, scheme, control, end, rows, points } = setup;
        positive("the end", end)?;
        match control {
            StepControl::Fixed(step) => positive("the step", step)?,
            StepControl::Tolerance(tolerance) => positive("the tolerance", tolerance)?,
        }
        match rows {
            Rows::EverySteps(_) => {}
            Rows::Interval(interval) => positive("the interval of the rows", interval)?,
        }
        let mut motion = SystemMotion::new(system, &states)?.with_scheme(scheme);
        let size = size(motion.system(), &states);
        let assembled = assemble(&mut motion, &states, relaxed, [size, end])?;
        let mut redundant: Vec<(String, usize)> = Vec::new();
        for (name, _) in
            motion.system().connections.names().zip(motion.implied_rows()).filter(|(_, is_implied)| *is_implied)
        {
            match redundant.last_mut() {
                Some((last, rows)) if last == name => *rows += 1,
                _ => redundant.push((name.to_owned(), 1)),
            }
        }
        let bodies = motion.system().bodies();
        let loads = || bodies.iter().flat_map(|body| body.loads());
        let of_joints = || motion.system().joints().iter().flat_map(|joint| joint.histories());
        let histories: Vec<History> = loads().filter_map(|load| load.history()).chain(of_joints()).cloned().collect();
        let formula_steps = FormulaSteps::new(&histories, end)?;
        let discontinuities: Vec<f64> = loads()
            .flat_map(|load| load.discontinuities())
            .chain(of_joints().flat_map(History::discontinuities))
            .collect();
        let count = bodies.len();
        Ok(Self {
            plan: Plan::new(end, discontinuities.into_iter(), rows),
            walk: Walk { segment: None, equal: EqualSteps::default(), next: FIRST * end, longest: f64::INFINITY },
            motion,
            control,
            rows,
            end,
            steps_since_row: 0,
            formula_steps,
            histories,
            points,
            size,
            assembled,
            redundant,
            stats: Stats { accepted: 0, rejected: 0, evaluations: 0, shortest: f64::INFINITY, longest: 0.0 },
            account: EnergyAccount::default(),
            exchanged: vec![Exchanged::default(); count],
        })
    }

    /// Time that has been reached.
    pub fn time(&self) -> f64 {
        self.motion.time()
    }

    /// Time at which the run ends.
    pub fn end(&self) -> f64 {
        self.end
    }

    /// The motion.
    pub fn motion(&self) -> &SystemMotion {
        &self.motion
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

    /// Degrees of freedom that the joints leave rigid bodies at the beginning.
    pub fn rigid_dofs(&self) -> usize {
        let system = self.motion.system();
        let implied: usize = self.redundant.iter().map(|(_, rows)| rows).sum();
        (6 * system.bodies().len() + implied).saturating_sub(system.rows())
    }

    /// Sum of |work of loads, joints and elements| + |dissipation| of all steps, of a body.
    pub fn exchanged(&self, body: usize) -> f64 {
        self.exchanged[body].sum
    }

    /// Cost of the run so far.
    pub fn stats(&self) -> Stats {
        Stats { evaluations: self.motion.evaluations(), ..self.stats }
    }

    /// Room for the motion of a body.
    pub fn room(&self, body: usize) -> Observation {
        Observation::new(self.motion.system().bodies()[body].flexible(), self.points[body].len())
    }

    /// Fills `out`, one for each body, with the motion at the time that has been reached.
    ///
    /// # Errors
    /// [`StepError`] where the inertia of a deformed body is singular, and where the energy is not finite, or is not what the
    /// start, the loads, the joints and the damping account for.
    pub fn observe<'o>(&mut self, out: impl IntoIterator<Item = &'o mut Observation>) -> Result<(), StepError> {
        let (time, step) = (self.time(), self.stats.longest);
        let in_step = |error: crate::RateError| error.in_step(time, step);
        self.motion.find_reactions().map_err(in_step)?;
        let mut sum = Energies { time, internal: 0.0, translation: 0.0, work: 0.0, dissipation: 0.0 };
        for (body, out) in out.into_iter().enumerate() {
            self.motion.observe(body, &self.points[body], out).map_err(in_step)?;
            if !out.is_finite() {
                return Err(StepError::NotFinite { time, what: "a quantity of the motion" });
            }
            sum.internal += out.energy();
            sum.work += out.work.work;
            sum.dissipation += out.work.dissipation;
        }
        self.account.check(&sum, 0.0, step)
    }

    /// Observes a joint, after [`Self::observe`].
    pub fn observe_joint(&self, joint: usize) -> JointObservation {
        self.motion.observe_joint(joint)
    }

    /// Goes on to the next row, or as far as `max_steps` tries lead; `watch` sees the motion of each body once for each step
    /// that is taken, rows or not.
    ///
    /// # Errors
    /// [`StepError`]; the motion stays where it was before the step that failed.
    pub fn advance_watched(
        &mut self,
        max_steps: u64,
        mut watch: impl FnMut(usize, &Moment),
    ) -> Result<Reached, StepError> {
        for _ in 0..max_steps {
            let Some(segment) = self.segment() else { return Ok(Reached::End) };
            let Some(length) = self.try_step(&segment)? else { continue };
            (0..self.exchanged.len()).for_each(|body| watch(body, &self.motion.moment(body)));
            self.count(length);
            let is_done = self.motion.time() >= segment.end;
            if is_done {
                self.walk.segment = None;
                if segment.discontinuity {
                    let (time, longest) = (self.time(), self.stats.longest);
                    self.motion.pass_discontinuity().map_err(|error| error.in_step(time, longest))?;
                }
            }
            let is_row = match self.rows {
                Rows::EverySteps(steps) => self.steps_since_row >= steps || self.plan.is_over(self.time()),
                Rows::Interval(_) => is_done && segment.row,
            };
            if is_row {
                self.steps_since_row = 0;
                return Ok(Reached::Row);
            }
        }
        Ok(Reached::Between)
    }

    /// The segment that the next step is in; `None` at the end.
    fn segment(&mut self) -> Option<Segment> {
        if let Some(segment) = self.walk.segment {
            return Some(segment);
        }
        let segment = self.plan.next_segment()?;
        // Step control does not see what swings within a step, where all its stages fall on like phases.
        let branch_time = segment.start + 0.5 * segment.length;
        let loads = self.motion.system().bodies().iter().flat_map(|body| body.loads());
        let of_loads = loads.map(|load| load.longest_step(branch_time));
        let of_histories = self.histories.iter().map(|history| history.longest_step(branch_time));
        let longest = of_loads.chain(of_histories).fold(self.formula_steps.longest_step(branch_time), f64::min);
        if let StepControl::Fixed(step) = self.control {
            self.walk.equal = EqualSteps::new(segment, step.min(longest));
        }
        (self.walk.segment, self.walk.longest) = (Some(segment), longest);
        Some(segment)
    }

    /// Tries a step. Returns its length where it was taken.
    fn try_step(&mut self, segment: &Segment) -> Result<Option<f64>, StepError> {
        let time = self.time();
        match self.control {
            StepControl::Fixed(_) => {
                let Some((h, end)) = self.walk.equal.next_step() else { return Ok(None) };
                match self.motion.try_step(h, end, EXACT, f64::INFINITY) {
                    Ok(Tried { .. }) => Ok(Some(h)),
                    Err(Failed::Newton) => Err(StepError::Newton { time, step: h }),
                    Err(Failed::Rates(error)) => Err(error.in_step(time, h)),
                }
            }
            StepControl::Tolerance(tolerance) => {
                let mut h = self.walk.next.min(self.walk.longest);
                let taken = self.motion.try_towards(segment.end, tolerance, &mut h)?;
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
        }
    }

    /// Counts a step that was taken.
    fn count(&mut self, length: f64) {
        self.stats.accepted += 1;
        self.stats.shortest = self.stats.shortest.min(length);
        self.stats.longest = self.stats.longest.max(length);
        self.steps_since_row += 1;
        let mut total = [0.0; 2];
        for (body, Exchanged { sum, done }) in self.exchanged.iter_mut().enumerate() {
            let now = self.motion.work_and_dissipation(body);
            *sum += (now[0] - done[0]).abs() + (now[1] - done[1]).abs();
            *done = now;
            total = [total[0] + now[0], total[1] + now[1]];
        }
        self.account.exchange(total);
    }

    /// The state that has been reached, as words; they are equally many for all states of a run.
    ///
    /// # Errors
    /// [`CheckpointError::Encoding`].
    pub fn checkpoint(&self) -> Result<Vec<u64>, CheckpointError> {
        let Stats { accepted, rejected, shortest, longest, .. } = self.stats;
        Ok(to_words(&encode(&encode(&Saved {
            motion: self.motion.saved(),
            plan: self.plan.progress(),
            walk: self.walk,
            steps_since_row: self.steps_since_row,
            account: self.account,
            exchanged: self.exchanged.clone(),
            accepted,
            rejected,
            lengths: [shortest, longest],
        })?)?))
    }

    /// Takes up the state of a [`Self::checkpoint`] of a run with the same set-up: what follows is what would have followed
    /// there, bit for bit.
    ///
    /// # Errors
    /// [`CheckpointError`] for a checkpoint of another run.
    pub fn restored(mut self, checkpoint: &[u64]) -> Result<Self, CheckpointError> {
        let saved: Vec<u8> = from_words(checkpoint)?;
        let saved: Saved = decode(&saved)?;
        let Saved { motion, plan, walk, steps_since_row, account, exchanged, accepted, rejected, lengths } = saved;
        counts(&[accepted, rejected, steps_since_row])?;
        expect("the length of a step", lengths[0] > 0.0 && lengths[1] >= 0.0)?;
        expect("the number of bodies", exchanged.len() == self.exchanged.len())?;
        finite("the energy exchanged", exchanged.iter().flat_map(|of| [&of.sum, &of.done[0], &of.done[1]]))?;
        walk.equal.check()?;
        expect("the next step", walk.next > 0.0 && walk.longest > 0.0)?;
        account.check_saved()?;
        self.motion.take_up(motion)?;
        self.plan.set_progress(&plan)?;
        self.stats = Stats { accepted, rejected, shortest: lengths[0], longest: lengths[1], ..self.stats };
        (self.walk, self.account, self.exchanged) = (walk, account, exchanged);
        self.steps_since_row = steps_since_row;
        Ok(self)
    }
}

/// Largest distance of bodies from the first, or the largest radius of gyration.
fn size(system: &System, states: &[MotionState]) -> f64 {
    let first = states.first().map_or_else(Vector3::zeros, |state| state.origin_global);
    let spread = states.iter().map(|state| (state.origin_global - first).norm());
    let radii = system.bodies().iter().map(|body| body.radius_of_gyration());
    spread.chain(radii).fold(f64::MIN_POSITIVE, f64::max)
}

/// A body that does not resist a motion.
const SINGULAR: SetupError = SetupError::Value { what: "the inertia of a body", found: 0.0, expected: "above 0" };

/// Moves the bodies so that the joints close, and finds by how much.
fn assemble(
    motion: &mut SystemMotion,
    states: &[MotionState],
    relaxed: bool,
    [size, end]: [f64; 2],
) -> Result<Vec<Assembled>, SetupError> {
    let open = motion.most_open().map_err(|_| SINGULAR)?;
    let done = if relaxed { motion.relax() } else { motion.assemble() };
    let [left, rates] = match (done, open) {
        (Ok(left), _) => left,
        // Bodies that are too far from where they have to be.
        (Err(_), Some((joint, [left, rate]))) => {
            return Err(SetupError::NotAssembled { joint: joint.into(), left, rate });
        }
        (Err(_), None) => return Err(SINGULAR),
    };
    let fastest = states.iter().map(|state| state.velocity_global.norm() + size * state.omega_body.norm());
    let is_open = |left: f64, scale: f64| left.is_nan() || left > CLOSED * scale;
    if is_open(left, size) || is_open(rates, size / end + fastest.fold(0.0, f64::max)) {
        let open = motion.most_open().ok().flatten();
        let joint = open.map_or_else(Box::default, |(joint, _)| joint.into());
        return Err(SetupError::NotAssembled { joint, left, rate: rates });
    }
    let changed = |(body, state): (usize, &MotionState)| {
        let now = motion.state(body).map_err(|_| SINGULAR)?;
        Ok(Assembled {
            moved: (now.origin_global - state.origin_global).norm(),
            turned: now.attitude.angle_to(&state.attitude),
            velocity: (now.velocity_global - state.velocity_global).norm(),
            angular_velocity: (now.omega_body - state.omega_body).norm(),
        })
    };
    states.iter().enumerate().map(changed).collect()
}
