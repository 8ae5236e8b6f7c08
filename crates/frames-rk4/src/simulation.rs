//! A run: a body, a method, the steps that lead through it, and the times at which it is observed.

use modal::ReducedBody;
use nalgebra::Vector3;

use crate::account::{self, EnergyAccount};
use crate::attitude_account::AttitudeAccount;
use crate::checkpoint::{RestoreError, Tape};
use crate::conservative::ConservativeBody;
use crate::conservative_motion::{ConservativeMotion, ConservativeScheme};
use crate::error::{SetupError, StepError};
use crate::formula_steps::FormulaSteps;
use crate::history::History;
use crate::initial::Initial;
use crate::load::Load;
use crate::model::ModalModel;
use crate::moment::Moment;
use crate::motion::PointShapes;
use crate::observation::Observation;
use crate::paper::PaperScheme;
use crate::paper_limit::PaperLimit;
use crate::physics::{DrivenMotion, Physics};
use crate::plan::{EqualSteps, HalvedSteps, Plan, Rows, StepControl};

/// Formulation and scheme.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// The paper's scheme, literally.
    Paper,
    /// The limit of the paper's scheme, by RKMK4.
    PaperRkmk4,
    /// The conservative form.
    Conservative(ConservativeScheme),
}

impl Method {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Paper,
        Self::PaperRkmk4,
        Self::Conservative(ConservativeScheme::Rkmk4),
        Self::Conservative(ConservativeScheme::Exponential),
        Self::Conservative(ConservativeScheme::Strang),
    ];

    /// The name of its formulation in a scene: "paper" or "conservative".
    pub fn formulation(self) -> &'static str {
        match self {
            Self::Paper | Self::PaperRkmk4 => "paper",
            Self::Conservative(_) => "conservative",
        }
    }

    /// The name of its scheme in a scene.
    pub fn scheme(self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::PaperRkmk4 | Self::Conservative(ConservativeScheme::Rkmk4) => "rkmk4",
            Self::Conservative(ConservativeScheme::Exponential) => "exponential",
            Self::Conservative(ConservativeScheme::Strang) => "strang",
        }
    }

    /// Order of convergence.
    pub fn order(self) -> u32 {
        match self {
            Self::Paper => 1,
            Self::Conservative(ConservativeScheme::Strang) => 2,
            _ => 4,
        }
    }

    /// Evaluations of the rates that a step takes.
    pub fn evaluations_per_step(self) -> u32 {
        4
    }

    /// Whether the step is limited by the highest mode, at about 2.83/ω_max; otherwise by the spin.
    pub fn limited_by_modes(self) -> bool {
        !matches!(self, Self::Conservative(ConservativeScheme::Exponential | ConservativeScheme::Strang))
    }

    /// Largest angle in rad that the body may turn through in a step of a method that the modes do not limit.
    ///
    /// Coriolis terms turn the modes with up to twice the spin, which the stages of RK4 follow to 2.83 in the step.
    /// Splitting is weaker: its steps fall into resonance with the modes, and an undamped body has been seen to blow up
    /// at 0.2.
    pub fn longest_turn(self) -> f64 {
        match self {
            Self::Conservative(ConservativeScheme::Strang) => 2.0_f64.sqrt() / 8.0,
            _ => 2.0_f64.sqrt(),
        }
    }

    /// Whether it estimates the error of a step.
    pub fn estimates_error(self) -> bool {
        matches!(self, Self::Conservative(ConservativeScheme::Exponential | ConservativeScheme::Rkmk4))
    }
}

/// Everything that a run needs.
#[derive(Debug, Clone)]
pub struct Setup<'a> {
    /// The body.
    pub body: &'a ReducedBody,
    /// One damping ratio for each flexible mode.
    pub damping_ratios: &'a [f64],
    /// The loads.
    pub loads: &'a [Load],
    /// Effects, drives and stress.
    pub physics: &'a Physics,
    /// R, P, Q of the paper's scheme, from the body's origin, body axes.
    pub reference_points: [Vector3<f64>; 3],
    /// How it begins.
    pub initial: &'a Initial,
    /// How it is stepped.
    pub method: Method,
    /// How long the steps are.
    pub control: StepControl,
    /// When it ends.
    pub end: f64,
    /// When it is observed.
    pub rows: Rows,
    /// Points whose motion is observed.
    pub points: &'a [PointShapes],
}

/// What a run has cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stats {
    /// Steps taken.
    pub accepted: u64,
    /// Steps tried in vain.
    pub rejected: u64,
    /// Evaluations of the rates.
    pub evaluations: u64,
    /// Length of the shortest step taken.
    pub shortest: f64,
    /// Length of the longest step taken.
    pub longest: f64,
}

/// Where [`Simulation::advance`] has come to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reached {
    /// A time at which the motion is to be observed.
    Row,
    /// Nothing yet, after as many steps as were allowed.
    Between,
    /// The end; the row there has been reached before.
    End,
}

/// A run in progress. As an iterator it yields the observations after the first.
#[derive(Debug, Clone)]
pub struct Simulation {
    engine: Engine,
    /// Of the loads and the drive.
    histories: Vec<History>,
    formula_steps: FormulaSteps,
    plan: Plan,
    walk: Walk,
    rows: Rows,
    end: f64,
    steps_since_row: u64,
    /// Whether the segment ends at a corner that has not been passed.
    corner_ahead: bool,
    points: Vec<PointShapes>,
    stats: Stats,
    account: EnergyAccount,
    attitude_account: AttitudeAccount,
    /// Largest of ω_k and 2 ζ_k ω_k.
    fastest_rate: f64,
    failed: bool,
}

/// The attitude is looked at after so many steps: often enough for a sum, and too seldom to cost anything.
const STEPS_OF_ATTITUDE: u64 = 8;

#[derive(Debug, Clone)]
enum Engine {
    Paper(Box<PaperScheme>),
    PaperLimit(Box<PaperLimit>),
    Conservative(Box<ConservativeMotion>),
}

/// The way through the segment of the moment.
#[derive(Debug, Clone)]
enum Walk {
    Equal { step: f64, steps: Option<(EqualSteps, bool)> },
    Halved { tolerance: f64, longest_try: f64, steps: Option<(HalvedSteps, bool)> },
}

impl Simulation {
    /// Begins a run.
    ///
    /// # Errors
    /// [`SetupError`]: lists of the wrong length, numbers out of range, a step beyond the limit of the method, a
    /// tolerance for a method without an error estimate.
    pub fn new(setup: &Setup) -> Result<Self, SetupError> {
        let Setup { body, damping_ratios, loads, initial, method, .. } = *setup;
        let positive = |what, value: f64| {
            if value > 0.0 && value.is_finite() {
                Ok(())
            } else {
                Err(SetupError::Value { what, found: value, expected: "a positive number" })
            }
        };
        positive("the end", setup.end)?;
        match setup.rows {
            Rows::EverySteps(0) => {
                return Err(SetupError::Value {
                    what: "the number of steps for a row",
                    found: 0.0,
                    expected: "1 or more",
                });
            }
            Rows::EverySteps(_) => {}
            Rows::Interval(interval) => positive("the interval of the rows", interval)?,
        }
        let walk = match setup.control {
            StepControl::Fixed(step) => {
                check_step(setup, step)?;
                Walk::Equal { step, steps: None }
            }
            StepControl::Tolerance(tolerance) => {
                positive("the tolerance", tolerance)?;
                if !method.estimates_error() {
                    return Err(SetupError::NoErrorEstimate {
                        formulation: method.formulation(),
                        scheme: method.scheme(),
                    });
                }
                Walk::Halved { tolerance, longest_try: f64::INFINITY, steps: None }
            }
        };
        if !matches!(method, Method::Conservative(_)) {
            refuse_beyond_paper(setup.physics)?;
        }
        let model = || ModalModel::new(body, damping_ratios, loads.to_vec());
        let has_formula = loads.iter().any(|load| load.history.has_formula());
        let mut energy_of_loads = 0.0;
        if has_formula && !matches!(method, Method::Conservative(_)) {
            let body = ConservativeBody::new(body, damping_ratios, loads.to_vec(), setup.physics)?;
            energy_of_loads = body.energy_of_loads(setup.end);
        }
        let engine = match method {
            Method::Paper => {
                // Its own step only matters for its iterator; here the plan gives the steps.
                let step = model()?.stable_step().1.min(setup.end);
                Engine::Paper(Box::new(PaperScheme::new(body, model()?, setup.reference_points, initial, step)?))
            }
            Method::PaperRkmk4 => Engine::PaperLimit(Box::new(PaperLimit::new(body, model()?, initial)?)),
            Method::Conservative(scheme) => {
                let body = ConservativeBody::new(body, damping_ratios, loads.to_vec(), setup.physics)?;
                let mut motion = ConservativeMotion::new(body, scheme, initial)?;
                let resolved = match setup.control {
                    StepControl::Fixed(step) => account::is_resolved(motion.fastest_rate(), step),
                    StepControl::Tolerance(_) => false,
                };
                if !resolved || has_formula {
                    energy_of_loads = motion.expect_loads_until(setup.end);
                }
                Engine::Conservative(Box::new(motion))
            }
        };
        let fastest_rate = match &engine {
            Engine::Paper(scheme) => scheme.fastest_rate(),
            Engine::PaperLimit(limit) => limit.fastest_rate(),
            Engine::Conservative(motion) => motion.fastest_rate(),
        };
        let of_loads = loads.iter().map(|load| &load.history);
        let histories: Vec<History> =
            of_loads.chain(setup.physics.drive.iter().map(|drive| &drive.history)).cloned().collect();
        let step = match setup.control {
            StepControl::Fixed(step) => Some(step),
            StepControl::Tolerance(_) => None,
        };
        let formula_steps = FormulaSteps::new(&histories, setup.end, step)?;
        let corners = histories.iter().flat_map(History::corners).chain(formula_steps.stops());
        Ok(Self {
            engine,
            plan: Plan::new(setup.end, corners, setup.rows),
            histories,
            formula_steps,
            walk,
            rows: setup.rows,
            end: setup.end,
            steps_since_row: 0,
            corner_ahead: false,
            points: setup.points.to_vec(),
            stats: Stats { accepted: 0, rejected: 0, evaluations: 0, shortest: f64::INFINITY, longest: 0.0 },
            account: EnergyAccount::new(energy_of_loads),
            attitude_account: AttitudeAccount::default(),
            fastest_rate,
            failed: false,
        })
    }

    /// Time that has been reached.
    pub fn time(&self) -> f64 {
        match &self.engine {
            Engine::Paper(scheme) => scheme.state().time,
            Engine::PaperLimit(limit) => limit.state().time,
            Engine::Conservative(motion) => motion.state().time,
        }
    }

    /// Time at which the run ends.
    pub fn end(&self) -> f64 {
        self.end
    }

    /// Room for an observation.
    pub fn observation(&self) -> Observation {
        let flexible = match &self.engine {
            Engine::Paper(scheme) => scheme.state().modal_displacement.len() - 6,
            Engine::PaperLimit(limit) => limit.state().modal_displacement.len() - 6,
            Engine::Conservative(motion) => motion.state().modal_displacement.len(),
        };
        Observation::new(flexible, self.points.len())
    }

    /// Fills `out` with the motion at the time that has been reached.
    ///
    /// # Errors
    /// [`StepError`] where the inertia of the deformed body is singular, where a quantity is not a finite number, and
    /// where the energy is not what the start, the loads and the damping account for.
    pub fn observe(&mut self, out: &mut Observation) -> Result<(), StepError> {
        match &mut self.engine {
            Engine::Paper(scheme) => scheme.observe(&self.points, out),
            Engine::PaperLimit(limit) => limit.observe(&self.points, out),
            Engine::Conservative(motion) => motion.observe(&self.points, out)?,
        }
        if let Some(what) = out.not_finite() {
            return Err(StepError::NotFinite { time: out.time, what });
        }
        self.check_energy()
    }

    /// Whether the energy, where it was last looked at, is what it should be. Of the conservative form that is the start
    /// of the last step or the last observation, since it takes an evaluation of the rates.
    fn check_energy(&mut self) -> Result<(), StepError> {
        let Self { engine, account, fastest_rate, stats, .. } = self;
        match engine {
            Engine::Paper(scheme) => account.check(&scheme.reckoning(), *fastest_rate, stats.longest),
            Engine::PaperLimit(limit) => account.check(&limit.reckoning(), *fastest_rate, stats.longest),
            Engine::Conservative(motion) => match motion.reckoning() {
                Some(now) => account.check(now, *fastest_rate, stats.longest),
                None => Ok(()),
            },
        }
    }

    fn moment(&self) -> Moment<'_> {
        let state = match &self.engine {
            Engine::Paper(scheme) => scheme.state(),
            Engine::PaperLimit(limit) => limit.state(),
            Engine::Conservative(motion) => return motion.moment(),
        };
        Moment {
            time: state.time,
            omega_body: state.omega_body,
            modal_displacement: &state.modal_displacement[6..],
            modal_velocity: &state.modal_velocity[6..],
        }
    }

    /// Work of the loads and dissipation since the beginning.
    fn done(&self) -> [f64; 2] {
        match &self.engine {
            Engine::Paper(scheme) => scheme.done(),
            Engine::PaperLimit(limit) => limit.done(),
            Engine::Conservative(motion) => motion.done(),
        }
    }

    /// Sum of |work of the loads| + |dissipation| of all steps so far: how much energy has come and gone.
    pub fn exchanged(&self) -> f64 {
        self.account.exchanged()
    }

    /// Whether the attitude can be right. The conservative form keeps the angular momentum; that of the paper need not.
    fn check_attitude(&mut self) -> Result<(), StepError> {
        let Self { engine, attitude_account, stats, .. } = self;
        match engine {
            Engine::Paper(scheme) => scheme.check_attitude(attitude_account, stats.longest),
            Engine::PaperLimit(limit) => limit.check_attitude(attitude_account, stats.longest),
            Engine::Conservative(_) => Ok(()),
        }
    }

    /// Notes the state that has been reached in `out`, instead of what it held.
    pub fn checkpoint(&mut self, out: &mut Vec<u64>) {
        out.clear();
        self.pass(&mut Tape::Note(out));
    }

    /// Takes up the state of a [`Self::checkpoint`] of a run with the same setup: what follows is what would have
    /// followed there, bit for bit.
    ///
    /// # Errors
    /// [`RestoreError`] for a checkpoint of another run.
    pub fn restored(mut self, checkpoint: &[u64]) -> Result<Self, RestoreError> {
        let mut tape = Tape::set(checkpoint);
        self.pass(&mut tape);
        tape.finish()?;
        Ok(self)
    }

    fn pass(&mut self, tape: &mut Tape) {
        match &mut self.engine {
            Engine::Paper(scheme) => scheme.pass(tape),
            Engine::PaperLimit(limit) => limit.pass(tape),
            Engine::Conservative(motion) => motion.pass(tape),
        }
        self.plan.pass(tape);
        match &mut self.walk {
            Walk::Equal { steps, .. } => pass_steps(steps, EqualSteps::BLANK, EqualSteps::pass, tape),
            Walk::Halved { longest_try, steps, .. } => {
                tape.number(longest_try);
                pass_steps(steps, HalvedSteps::BLANK, HalvedSteps::pass, tape);
            }
        }
        tape.count(&mut self.steps_since_row);
        tape.flag(&mut self.corner_ahead);
        self.account.pass(tape);
        self.attitude_account.pass(tape);
        let Stats { accepted, rejected, evaluations: _, shortest, longest } = &mut self.stats;
        tape.count(accepted);
        tape.count(rejected);
        tape.number(shortest);
        tape.number(longest);
    }

    /// What the run has cost so far.
    pub fn stats(&self) -> Stats {
        let evaluations = match &self.engine {
            Engine::Paper(scheme) => scheme.evaluations(),
            Engine::PaperLimit(limit) => limit.evaluations(),
            Engine::Conservative(motion) => motion.evaluations(),
        };
        Stats { evaluations, ..self.stats }
    }

    /// Goes on to the next row, or as far as `most_steps` tries lead. Allocates nothing once each length of step has
    /// occurred.
    ///
    /// # Errors
    /// [`StepError`]; the motion stays where it was before the step that failed, or where its energy was found wrong.
    pub fn advance(&mut self, most_steps: u64) -> Result<Reached, StepError> {
        self.advance_watched(most_steps, |_| ())
    }

    /// As [`Self::advance`]; `watch` sees the motion once for each step that is taken, rows or not.
    ///
    /// # Errors
    /// As [`Self::advance`].
    pub fn advance_watched(&mut self, most_steps: u64, mut watch: impl FnMut(&Moment)) -> Result<Reached, StepError> {
        if self.account.is_empty() {
            self.check_energy()?;
        }
        if self.stats.accepted == 0 {
            self.check_attitude()?;
        }
        for _ in 0..most_steps {
            match self.next_step() {
                None => return Ok(Reached::End),
                Some((h, end, row_at_end)) => {
                    if !self.try_step(h, end)? {
                        continue;
                    }
                    watch(&self.moment());
                    if self.corner_ahead && self.segment_is_done() {
                        self.corner_ahead = false;
                        if let Engine::Conservative(motion) = &mut self.engine {
                            motion.pass_corner()?;
                        }
                    }
                    // Under step control, steps are tried in pairs.
                    let (count, length) = if self.is_controlled() { (2, 0.5 * h) } else { (1, h) };
                    self.stats.accepted += count;
                    self.stats.shortest = self.stats.shortest.min(length);
                    self.stats.longest = self.stats.longest.max(length);
                    self.account.exchange(self.done());
                    self.check_energy()?;
                    if self.stats.accepted.is_multiple_of(STEPS_OF_ATTITUDE) {
                        self.check_attitude()?;
                    }
                    self.steps_since_row += count;
                    let at_row = match self.rows {
                        Rows::EverySteps(steps) => self.steps_since_row >= steps || end >= self.end,
                        Rows::Interval(_) => row_at_end && self.segment_is_done(),
                    };
                    if at_row {
                        self.steps_since_row = 0;
                        return Ok(Reached::Row);
                    }
                }
            }
        }
        Ok(Reached::Between)
    }

    /// Length and end of the next step, and whether its segment ends at an output time; `None` at the end.
    fn next_step(&mut self) -> Option<(f64, f64, bool)> {
        loop {
            let next = match &mut self.walk {
                Walk::Equal { steps: Some((steps, row)), .. } => steps.next_step().map(|(h, end)| (h, end, *row)),
                Walk::Halved { steps: Some((steps, row)), .. } => steps.next_step().map(|(h, end)| (h, end, *row)),
                _ => None,
            };
            if next.is_some() {
                return next;
            }
            let segment = self.plan.next_segment()?;
            self.corner_ahead = segment.corner;
            // Step control does not see what swings within a step either, where all its stages fall on like phases.
            let inside = segment.start + 0.5 * segment.length;
            let of_histories = self.histories.iter().map(|history| history.longest_step(inside));
            let longest = of_histories.fold(self.formula_steps.longest_step(inside), f64::min);
            match &mut self.walk {
                Walk::Equal { step, steps } => {
                    *steps = Some((EqualSteps::new(segment, step.min(longest)), segment.row));
                }
                Walk::Halved { longest_try, steps, .. } => {
                    *steps = Some((HalvedSteps::new(segment, *longest_try, longest), segment.row));
                }
            }
        }
    }

    fn is_controlled(&self) -> bool {
        matches!(self.walk, Walk::Halved { .. })
    }

    fn segment_is_done(&self) -> bool {
        match &self.walk {
            Walk::Equal { steps: Some((steps, _)), .. } => steps.is_done(),
            Walk::Halved { steps: Some((steps, _)), .. } => steps.next_step().is_none(),
            _ => true,
        }
    }

    /// Does a step; under step control, `false` where it was rejected.
    fn try_step(&mut self, h: f64, end: f64) -> Result<bool, StepError> {
        let time = self.time();
        match (&mut self.engine, &mut self.walk) {
            (Engine::Conservative(motion), Walk::Halved { tolerance, longest_try, steps: Some((steps, _)) }) => {
                // Each step may take its share of the tolerance, so that the estimates of all steps sum to it. Where the
                // share is below rounding, a shorter step would be no better.
                let allowed = (*tolerance * h / self.end).max(f64::EPSILON);
                let error = match motion.controlled_steps(0.5 * h, end, allowed) {
                    Ok(estimate) => estimate / allowed,
                    // A step so long that it cannot even be tried.
                    Err(_) => f64::INFINITY,
                };
                if error <= 1.0 {
                    steps.accept(error);
                    // A step that only the segment's end made short says nothing about the next segment.
                    *longest_try = longest_try.max(steps.length());
                    return Ok(true);
                }
                self.stats.rejected += 1;
                if steps.reject(error) {
                    *longest_try = steps.length();
                    Ok(false)
                } else {
                    Err(StepError::Tolerance { time, step: h, tolerance: *tolerance })
                }
            }
            (Engine::Conservative(motion), _) => motion.step(h, end).map(|()| true),
            (Engine::Paper(scheme), _) => scheme.take_step(h, end).map(|()| true),
            (Engine::PaperLimit(limit), _) => limit.step(h, end).map(|()| true),
        }
    }
}

impl Iterator for Simulation {
    type Item = Result<Observation, StepError>;

    /// The observation at the next row; `None` at the end and after an error.
    fn next(&mut self) -> Option<Self::Item> {
        if self.failed {
            return None;
        }
        loop {
            match self.advance(u64::MAX) {
                Ok(Reached::Between) => {}
                Ok(Reached::End) => return None,
                Ok(Reached::Row) => {
                    let mut out = self.observation();
                    let result = self.observe(&mut out).map(|()| out);
                    self.failed = result.is_err();
                    return Some(result);
                }
                Err(error) => {
                    self.failed = true;
                    return Some(Err(error));
                }
            }
        }
    }
}

/// Passes over the steps through a segment, which there are none of before the first.
fn pass_steps<S>(steps: &mut Option<(S, bool)>, blank: S, pass: fn(&mut S, &mut Tape), tape: &mut Tape) {
    let mut there = steps.is_some();
    tape.flag(&mut there);
    // Passed even where there are none, so that every checkpoint of a run has the same length.
    let (inner, row) = steps.get_or_insert((blank, false));
    pass(inner, tape);
    tape.flag(row);
    if !there {
        *steps = None;
    }
}

/// Refuses a step beyond the limit of the method: that of the highest mode for Runge–Kutta, that of the spin else.
fn check_step(setup: &Setup, step: f64) -> Result<(), SetupError> {
    let model = ModalModel::new(setup.body, setup.damping_ratios, setup.loads.to_vec())?;
    if setup.method.limited_by_modes() {
        return model.check_step(step);
    }
    if !(step > 0.0 && step.is_finite()) {
        return Err(SetupError::Value { what: "the step", found: step, expected: "a positive number" });
    }
    if setup.method == Method::Conservative(ConservativeScheme::Strang) && !setup.loads.is_empty() {
        check_splitting(&setup.body.circular_frequencies, step)?;
    }
    let driven = setup.physics.drive.as_ref().map_or(0.0, |drive| match drive.motion {
        DrivenMotion::Turn { .. } => (drive.amplitude * drive.history.largest(setup.end)).abs(),
        DrivenMotion::Slide { .. } => 0.0,
    });
    let spin = setup.initial.omega.norm().max(driven);
    let limit = setup.method.longest_turn() / spin;
    if step <= limit { Ok(()) } else { Err(SetupError::StepBeyondSpin { step, limit, spin }) }
}

/// Refuses a step in which a mode turns by more than π: with x = ωh, splitting answers a static load with (x/2) cot(x/2)
/// of the deflection, which has the wrong sign beyond π and no bound at 2π.
fn check_splitting(circular_frequencies: &[f64], step: f64) -> Result<(), SetupError> {
    let fastest = circular_frequencies.iter().copied().enumerate().fold((0, 0.0), |a, b| if b.1 > a.1 { b } else { a });
    let limit = std::f64::consts::PI / fastest.1;
    if step <= limit {
        return Ok(());
    }
    let frequency = fastest.1 / std::f64::consts::TAU;
    Err(SetupError::StepBeyondSplitting { step, limit, mode: fastest.0 + 1, frequency })
}

/// Refuses what the formulation of the paper has not got.
fn refuse_beyond_paper(physics: &Physics) -> Result<(), SetupError> {
    let what = if physics.drive.is_some() {
        "driven motion"
    } else if physics.load_stiffness.is_some() {
        "geometric stiffening"
    } else {
        return Ok(());
    };
    Err(SetupError::NotInPaper { what })
}
