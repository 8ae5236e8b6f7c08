//! The bodies in motion between communication points, under inputs that are held in between.

use std::sync::Arc;

use diagnostic::Failure;
use flexframe::advice::Review;
use flexframe::dynamics::{
    History, Initial, JointLaw, LoadFrame, PointForce, PointMoment, Reached, Rows, Run, ScaledLoad, SharedLoad, Signal,
    StepError,
};
use flexframe::fmu::{FmuBody, FmuModel, Input, InputKind, Source};
use flexframe::model::Model;
use flexframe::motion::{BodyForces, JointForces, StartSettings, begin};
use flexframe::nalgebra::Vector3;
use flexframe::row::{BodyRow, Row};
use self_cell::self_cell;
use serde::{Deserialize, Serialize};

use crate::error::{no_bytes, no_state, refused};

/// Part of the end that a communication step has to have: the least step of a scene.
const SHORTEST: f64 = 1e-12;
/// Part of the step by which a communication point may be off, since importing programs add up steps.
const ROUNDING: f64 = 1e-6;

struct Owner {
    fmu: FmuModel,
    /// One for each body.
    initial: Vec<Initial>,
}

type Reviews<'a> = Vec<Review<'a>>;

self_cell!(
    /// The model, and the reviews of the motions of its bodies, which look at it.
    struct Reviewed {
        owner: Owner,
        #[not_covariant]
        dependent: Reviews,
    }
);

impl Reviewed {
    fn of(owner: Owner) -> Self {
        Self::new(owner, |Owner { fmu, initial }| {
            let bodies = fmu.bodies.iter().zip(initial);
            let reviews = bodies.map(|(FmuBody { body, model, .. }, initial)| {
                Review::new(model.case(body, initial), model.physics.effects, &model.advice)
            });
            reviews.collect()
        })
    }
}

/// Bodies in motion, all at one time.
pub struct Motion {
    reviewed: Option<Reviewed>,
    run: Run,
    /// One for each input variable, in their order.
    inputs: Vec<Channel>,
    /// True of an island of which an input has been set since the last step.
    changed: Vec<bool>,
    row: Row,
    numbers: Vec<f64>,
    /// True if `numbers` are those of the state and the inputs as they are.
    known: bool,
    /// Warnings that the logger has had, of each body.
    told: Vec<(usize, std::mem::Discriminant<flexframe::advice::Broken>)>,
}

/// An input and its way into the simulation.
struct Channel {
    input: Input,
    value: f64,
    signal: Signal,
}

/// Contents of a state of an FMU.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct State {
    checkpoint: Vec<u64>,
    inputs: Vec<(f64, [f64; 3])>,
    changed: Vec<bool>,
}

impl Motion {
    /// From the beginning of the scene to its end or the `stop` time, if that is later; times in the scene's unit.
    pub fn new(fmu: FmuModel, stop: Option<f64>) -> Result<Self, (Box<FmuModel>, Failure)> {
        let initial: Vec<Initial> = fmu.bodies.iter().map(|body| body.model.initial(&body.body)).collect();
        let inputs: Vec<Channel> = fmu.variables.iter().filter_map(|variable| channel(variable.source)).collect();
        let run = match run(&fmu, &inputs, stop) {
            Ok(run) => run,
            Err(error) => return Err((Box::new(fmu), error)),
        };
        Ok(Self {
            row: Row {
                time: 0.0,
                bodies: fmu.bodies.iter().map(|body| BodyRow::new(&body.model)).collect(),
                joints: run.room_of_joints(),
            },
            reviewed: Some(Reviewed::of(Owner { fmu, initial })),
            changed: vec![false; run.islands().len()],
            run,
            inputs,
            numbers: Vec::new(),
            known: false,
            told: Vec::new(),
        })
    }

    /// The model, for another run.
    pub fn into_model(self) -> Option<FmuModel> {
        self.reviewed.map(|reviewed| reviewed.into_owner().fmu)
    }

    /// Time, in the scene's unit.
    pub fn time(&self) -> f64 {
        if self.run.islands().is_empty() { 0.0 } else { self.run.time() }
    }

    /// The value of an input, by its number among the inputs.
    pub fn input(&self, number: usize) -> f64 {
        self.inputs.get(number).map_or(0.0, |channel| channel.value)
    }

    /// Sets an input from now on.
    pub fn set_input(&mut self, number: usize, value: f64) {
        let time = self.time();
        let Some(channel) = self.inputs.get_mut(number).filter(|channel| channel.value != value) else { return };
        match channel.input.kind {
            // The speed goes on from where it is.
            InputKind::DriveAcceleration => channel.signal.ramp(time, channel.signal.at(time), value),
            _ => channel.signal.hold(value),
        }
        channel.value = value;
        self.known = false;
        let body = channel.input.body;
        let islands = self.run.islands().iter();
        let changed = islands.zip(&mut self.changed).find(|(island, _)| island.bodies.contains(&body));
        changed.into_iter().for_each(|(_, changed)| *changed = true);
    }

    /// The numbers of a row of a results file, now.
    pub fn numbers(&mut self) -> Result<&[f64], Failure> {
        if !self.known {
            let words = |error| {
                format!("the outputs cannot be found: {error}; set other inputs, or a state that was saved before")
            };
            self.observe().map_err(|error| refused(words(error)))?;
        }
        Ok(&self.numbers)
    }

    fn observe(&mut self) -> Result<(), Failure> {
        let Some(reviewed) = &self.reviewed else { return Ok(()) };
        let fmu = &reviewed.borrow_owner().fmu;
        let Self { run, row, .. } = self;
        row.time = run
            .observe(row.bodies.iter_mut().map(|body| &mut body.motion), &mut row.joints)
            .map_err(StepError::from)?;
        for (number, (row, body)) in row.bodies.iter_mut().zip(&fmu.bodies).enumerate() {
            let own = self.inputs.iter().filter(|channel| channel.input.body == number);
            let factor = |load: usize| {
                let of_load = own.clone().find(|channel| channel.input.kind == InputKind::Factor(load));
                of_load.map_or(1.0, |channel| channel.value)
            };
            row.complete_with(&body.model, factor);
        }
        fmu.numbers(&self.row, &mut self.numbers);
        self.known = true;
        Ok(())
    }

    /// Goes on from `point` by `step`, in the scene's unit of time. After an error everything is as it was.
    pub fn go(&mut self, point: f64, step: f64) -> Result<(), Failure> {
        let (time, end) = (self.time(), self.run.end());
        let least = SHORTEST * end;
        if !(step >= least && step.is_finite()) {
            return Err(refused(format!(
                "the communication step is {step}; give a step of at least {least:e}, forward in time; the FMU stays at time {time}"
            )));
        }
        let slack = ROUNDING * step;
        let is_here = (point - time).abs() <= slack;
        if !is_here {
            return Err(refused(format!(
                "the communication point is {point}, but the FMU is at time {time}; go on from there, or set a state that was saved at {point}"
            )));
        }
        let mut target = point + step;
        if target > end + slack {
            return Err(refused(format!(
                "a step to time {target} is beyond the end at {end}; set a longer stop time in fmi2SetupExperiment, or pack the scene with a later time.end; the FMU stays at time {time}"
            )));
        }
        if (target - end).abs() <= slack {
            target = end;
        }
        let before = (self.run.clone(), self.changed.clone());
        for (island, changed) in self.run.islands_mut().iter_mut().zip(&mut self.changed) {
            if std::mem::take(changed) {
                island.motion.loads_have_changed();
            }
        }
        self.advance_to(target).map_err(|source| {
            (self.run, self.changed) = before;
            self.known = false;
            // What the failed step has shown is not to be held against what comes.
            self.reviewed = self.reviewed.take().map(|reviewed| Reviewed::of(reviewed.into_owner()));
            refused(format!(
                "the step failed: {source}. The FMU stays at time {time}, before the step: other inputs may be set and the step be tried again, or an earlier state be set"
            ))
        })
    }

    fn advance_to(&mut self, target: f64) -> Result<(), Failure> {
        let Self { run, reviewed, .. } = self;
        let Some(reviewed) = reviewed else { return Ok(()) };
        reviewed.with_dependent_mut(|Owner { fmu, .. }, reviews| advance(run, reviews, &fmu.bodies, target))?;
        self.observe()?;
        let Self { row, reviewed: Some(reviewed), .. } = self else { return Ok(()) };
        let reviews = |reviews: &mut Reviews<'_>| {
            reviews.iter_mut().zip(&row.bodies).try_for_each(|(review, body)| review.observe(body))
        };
        Ok(reviewed.with_dependent_mut(|_, of_bodies| reviews(of_bodies))?)
    }

    /// Doubts about the model, each only once.
    pub fn warnings(&mut self) -> Vec<String> {
        let Some(reviewed) = &self.reviewed else { return Vec::new() };
        let broken: Vec<_> = reviewed.with_dependent(|_, reviews| reviews.iter().map(Review::broken).collect());
        let mut new = Vec::new();
        for (body, broken) in
            broken.into_iter().enumerate().flat_map(|(body, all)| all.into_iter().map(move |b| (body, b)))
        {
            let kind = (body, std::mem::discriminant(&broken));
            if !self.told.contains(&kind) {
                self.told.push(kind);
                let scene = &reviewed.borrow_owner().fmu.bodies[body].body;
                new.push(match &scene.name {
                    Some(name) => format!("body {name}: {broken}"),
                    None => broken.to_string(),
                });
            }
        }
        new
    }

    /// The state with the inputs.
    pub fn state(&self) -> Result<State, Failure> {
        let inputs = self.inputs.iter().map(|channel| (channel.value, channel.signal.numbers())).collect();
        Ok(State { checkpoint: self.run.checkpoint().map_err(no_state)?, inputs, changed: self.changed.clone() })
    }

    /// Goes on from a state of this FMU. After an error everything is as it was.
    pub fn set_state(&mut self, state: &State) -> Result<(), Failure> {
        let finite = |(value, numbers): &(f64, [f64; 3])| value.is_finite() && numbers.iter().all(|n| n.is_finite());
        let fits = state.inputs.len() == self.inputs.len() && state.changed.len() == self.changed.len();
        if !(fits && state.inputs.iter().all(finite)) {
            return Err(no_bytes());
        }
        self.run = self.run.clone().restored(&state.checkpoint).map_err(no_state)?;
        for (channel, (value, numbers)) in self.inputs.iter_mut().zip(&state.inputs) {
            channel.value = *value;
            channel.signal.set(*numbers);
        }
        (self.changed, self.known) = (state.changed.clone(), false);
        self.reviewed = self.reviewed.take().map(|reviewed| Reviewed::of(reviewed.into_owner()));
        Ok(())
    }
}

fn channel(source: Source) -> Option<Channel> {
    let Source::Input(input) = source else { return None };
    Some(Channel { input, value: input.start(), signal: Signal::held(input.start()) })
}

/// Goes on to a time, under the eyes of the reviews of its bodies.
fn advance(run: &mut Run, reviews: &mut [Review<'_>], bodies: &[FmuBody], target: f64) -> Result<(), Failure> {
    run.set_stop_time(Some(target));
    loop {
        let reached = run.advance(u64::MAX, |body, instant| reviews[body].look(instant));
        // A step that fails after the model has come to mean nothing fails for that.
        let refusing = bodies.iter().zip(&*reviews).filter(|(body, _)| body.body.effects.refuse);
        if let Some((time, refusal)) = refusing.filter_map(|(_, review)| review.stop()).next() {
            return Err(refused(format!("at time {time:.6}: {refusal}")));
        }
        match reached.map_err(StepError::from)? {
            Reached::Stop | Reached::End => return Ok(()),
            _ if run.time() >= target => return Ok(()),
            _ => {}
        }
    }
}

/// A motor that an input drives.
#[derive(Debug)]
struct Motor(Signal);

impl JointLaw for Motor {
    fn force(&self, [time, _]: [f64; 2], _: [f64; 2]) -> f64 {
        self.0.at(time)
    }

    fn stiffness_and_damping(&self, _: [f64; 2], _: [f64; 2]) -> [f64; 2] {
        [0.0; 2]
    }
}

/// The run of the bodies, with the inputs.
fn run(fmu: &FmuModel, inputs: &[Channel], stop: Option<f64>) -> Result<Run, Failure> {
    let models: Vec<&Model> = fmu.bodies.iter().map(|body| &body.model).collect();
    let rows = Rows::EverySteps(u64::MAX);
    let mut beginning = StartSettings { rows, ..StartSettings::of(&fmu.scene, &models) };
    beginning.end = stop.unwrap_or(0.0).max(beginning.end);
    for (number, (body, forces)) in fmu.bodies.iter().zip(&mut beginning.bodies).enumerate() {
        connect(body, forces, inputs.iter().filter(|channel| channel.input.body == number));
    }
    for Channel { input, signal, .. } in inputs {
        if let InputKind::Motor(joint, along) = input.kind {
            beginning.laws.push(JointForces { joint, along, law: Arc::new(Motor(signal.clone())) });
        }
    }
    begin(&fmu.scene, &models, &beginning).map_err(|error| refused(format!("the motion cannot start: {error}")))
}

/// Lets inputs act on a body.
fn connect<'c>(body: &FmuBody, forces: &mut BodyForces, inputs: impl Iterator<Item = &'c Channel>) {
    let FmuBody { model, rotations, .. } = body;
    let BodyForces { loads, physics, .. } = forces;
    let axis = |axis: usize| Vector3::from_fn(|i, _| if i == axis { 1.0 } else { 0.0 });
    for Channel { input, signal, .. } in inputs {
        let factor = signal.clone();
        let unit: SharedLoad = match input.kind {
            InputKind::Factor(load) => {
                if let Some(load) = loads.get_mut(load) {
                    *load = Arc::new(ScaledLoad { load: Arc::clone(load), factor });
                }
                continue;
            }
            InputKind::DriveAcceleration => {
                if let Some(drive) = &mut physics.drive {
                    drive.added = Some(factor);
                }
                continue;
            }
            InputKind::Motor(..) => continue,
            InputKind::Force(point, component) => {
                let Some((_, point)) = model.points.get(point) else { continue };
                Arc::new(PointForce::dead(point.clone(), axis(component), History::Constant))
            }
            InputKind::Moment(point, component) => {
                let Some(rotation) = rotations.get(point).cloned() else { continue };
                let (frame, history) = (LoadFrame::Global, History::Constant);
                Arc::new(PointMoment { rotation, moment: axis(component), frame, history })
            }
        };
        loads.push(Arc::new(ScaledLoad { load: unit, factor }));
    }
}
