//! The body in motion between communication points, under inputs that are held in between.

use std::sync::Arc;

use flexframe::advice::Review;
use flexframe::dynamics::{
    History, Initial, LoadFrame, Physics, PointForce, PointMoment, PointShapes, Reached, Rows, ScaledLoad, Setup,
    SharedLoad, Signal, Simulation,
};
use flexframe::fmu::{FmuModel, Input, Source};
use flexframe::nalgebra::Vector3;
use flexframe::row::Row;
use self_cell::self_cell;
use serde::{Deserialize, Serialize};

use crate::error::{Error, Failure};

/// Part of the end that a communication step has to have: the least step of a scene.
const SHORTEST: f64 = 1e-12;
/// Part of the step by which a communication point may be off, since importing programs add up steps.
const ROUNDING: f64 = 1e-6;

struct Owner {
    fmu: FmuModel,
    initial: Initial,
}

self_cell!(
    /// The model, and the review of its motion, which looks at it.
    struct Reviewed {
        owner: Owner,
        #[not_covariant]
        dependent: Review,
    }
);

impl Reviewed {
    fn of(owner: Owner) -> Self {
        Self::new(owner, |Owner { fmu, initial }| {
            Review::new(fmu.model.case(&fmu.scene, initial), fmu.model.physics.effects, &fmu.model.advice)
        })
    }
}

/// A body in motion.
pub struct Motion {
    reviewed: Option<Reviewed>,
    simulation: Simulation,
    /// One for each input variable, in their order.
    inputs: Vec<Channel>,
    /// True if an input has been set since the last step.
    changed: bool,
    row: Row,
    numbers: Vec<f64>,
    /// True if `numbers` are those of the state and the inputs as they are.
    known: bool,
    /// Warnings that the logger has had.
    told: Vec<std::mem::Discriminant<flexframe::advice::Broken>>,
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
    changed: bool,
}

impl Motion {
    /// From the beginning of the scene to its end or the `stop` time, if that is later; times in the scene's unit.
    pub fn new(fmu: FmuModel, stop: Option<f64>) -> Result<Self, (Box<FmuModel>, Error)> {
        let initial = fmu.model.initial(&fmu.scene);
        let inputs: Vec<Channel> = fmu.variables.iter().filter_map(|variable| channel(variable.source)).collect();
        let simulation = match simulation(&fmu, &initial, &inputs, stop) {
            Ok(simulation) => simulation,
            Err(error) => return Err((Box::new(fmu), error)),
        };
        Ok(Self {
            row: Row::new(&fmu.model),
            reviewed: Some(Reviewed::of(Owner { fmu, initial })),
            simulation,
            inputs,
            changed: false,
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
        self.simulation.time()
    }

    /// The value of an input, by its number among the inputs.
    pub fn input(&self, number: usize) -> f64 {
        self.inputs.get(number).map_or(0.0, |channel| channel.value)
    }

    /// Sets an input from now on.
    pub fn set_input(&mut self, number: usize, value: f64) {
        let time = self.simulation.time();
        let Some(channel) = self.inputs.get_mut(number).filter(|channel| channel.value != value) else { return };
        match channel.input {
            // The speed goes on from where it is.
            Input::DriveAcceleration => channel.signal.ramp(time, channel.signal.at(time), value),
            _ => channel.signal.hold(value),
        }
        channel.value = value;
        (self.changed, self.known) = (true, false);
    }

    /// The numbers of a row of a results file, now.
    pub fn numbers(&mut self) -> Result<&[f64], Error> {
        if !self.known {
            self.observe().map_err(Error::Outputs)?;
        }
        Ok(&self.numbers)
    }

    fn observe(&mut self) -> Result<(), Failure> {
        self.simulation.observe(&mut self.row.motion)?;
        let Some(reviewed) = &self.reviewed else { return Ok(()) };
        let fmu = &reviewed.borrow_owner().fmu;
        self.row.complete(&fmu.model);
        fmu.numbers(&self.row, &mut self.numbers);
        self.known = true;
        Ok(())
    }

    /// Goes on from `point` by `step`, in the scene's unit of time. After an error everything is as it was.
    pub fn go(&mut self, point: f64, step: f64) -> Result<(), Error> {
        let (time, end) = (self.simulation.time(), self.simulation.end());
        let least = SHORTEST * end;
        if !(step >= least && step.is_finite()) {
            return Err(Error::Step { found: step, least, time });
        }
        let slack = ROUNDING * step;
        let is_here = (point - time).abs() <= slack;
        if !is_here {
            return Err(Error::Point { found: point, time });
        }
        let mut target = point + step;
        if target > end + slack {
            return Err(Error::End { found: target, end, time });
        }
        if (target - end).abs() <= slack {
            target = end;
        }
        let before = self.simulation.clone();
        if std::mem::take(&mut self.changed) {
            self.simulation.loads_have_changed();
        }
        self.advance_to(target).map_err(|source| {
            self.simulation = before;
            (self.changed, self.known) = (true, false);
            // What the failed step has shown is not to be held against what comes.
            self.reviewed = self.reviewed.take().map(|reviewed| Reviewed::of(reviewed.into_owner()));
            Error::Failed { source, time }
        })
    }

    fn advance_to(&mut self, target: f64) -> Result<(), Failure> {
        let Self { simulation, reviewed, .. } = self;
        let Some(reviewed) = reviewed else { return Ok(()) };
        simulation.set_stop_time(Some(target));
        reviewed.with_dependent_mut(|Owner { fmu, .. }, review| {
            loop {
                let reached = simulation.advance_watched(u64::MAX, |moment| review.look(moment));
                // A step that fails after the model has come to mean nothing fails for that.
                if let Some((time, refusal)) = review.stop().filter(|_| fmu.scene.effects.refuse) {
                    return Err(Failure::Refused { time, words: refusal.to_string() });
                }
                match reached? {
                    Reached::Stop | Reached::End => return Ok(()),
                    _ if simulation.time() >= target => return Ok(()),
                    _ => {}
                }
            }
        })?;
        self.observe()?;
        let Self { row, reviewed: Some(reviewed), .. } = self else { return Ok(()) };
        Ok(reviewed.with_dependent_mut(|_, review| review.observe(row))?)
    }

    /// Doubts about the model, each only once.
    pub fn warnings(&mut self) -> Vec<String> {
        let Some(reviewed) = &self.reviewed else { return Vec::new() };
        let broken = reviewed.with_dependent(|_, review| review.broken());
        let mut new = Vec::new();
        for broken in broken {
            let kind = std::mem::discriminant(&broken);
            if !self.told.contains(&kind) {
                self.told.push(kind);
                new.push(broken.to_string());
            }
        }
        new
    }

    /// The state with the inputs.
    pub fn state(&self) -> Result<State, Error> {
        let inputs = self.inputs.iter().map(|channel| (channel.value, channel.signal.numbers())).collect();
        Ok(State { checkpoint: self.simulation.checkpoint()?, inputs, changed: self.changed })
    }

    /// Goes on from a state of this FMU. After an error everything is as it was.
    pub fn set_state(&mut self, state: &State) -> Result<(), Error> {
        let finite = |(value, numbers): &(f64, [f64; 3])| value.is_finite() && numbers.iter().all(|n| n.is_finite());
        if state.inputs.len() != self.inputs.len() || !state.inputs.iter().all(finite) {
            return Err(Error::Bytes);
        }
        self.simulation = self.simulation.clone().restored(&state.checkpoint)?;
        for (channel, (value, numbers)) in self.inputs.iter_mut().zip(&state.inputs) {
            channel.value = *value;
            channel.signal.set(*numbers);
        }
        (self.changed, self.known) = (state.changed, false);
        self.reviewed = self.reviewed.take().map(|reviewed| Reviewed::of(reviewed.into_owner()));
        Ok(())
    }
}

fn channel(source: Source) -> Option<Channel> {
    let Source::Input(input) = source else { return None };
    Some(Channel { input, value: input.start(), signal: Signal::held(input.start()) })
}

fn simulation(fmu: &FmuModel, initial: &Initial, inputs: &[Channel], stop: Option<f64>) -> Result<Simulation, Error> {
    let model = &fmu.model;
    let mut loads = model.loads().to_vec();
    let mut physics: Physics = model.physics.clone();
    let axis = |axis: usize| Vector3::from_fn(|i, _| if i == axis { 1.0 } else { 0.0 });
    for Channel { input, signal, .. } in inputs {
        let factor = signal.clone();
        let unit: SharedLoad = match *input {
            Input::Factor(load) => {
                if let Some(load) = loads.get_mut(load) {
                    *load = Arc::new(ScaledLoad { load: Arc::clone(load), factor });
                }
                continue;
            }
            Input::DriveAcceleration => {
                if let Some(drive) = &mut physics.drive {
                    drive.added = Some(factor);
                }
                continue;
            }
            Input::Force(point, component) => {
                let Some((_, point)) = model.points.get(point) else { continue };
                Arc::new(PointForce::dead(point.clone(), axis(component), History::Constant))
            }
            Input::Moment(point, component) => {
                let Some(rotation) = fmu.rotations.get(point).cloned() else { continue };
                let (frame, history) = (LoadFrame::Global, History::Constant);
                Arc::new(PointMoment { rotation, moment: axis(component), frame, history })
            }
        };
        loads.push(Arc::new(ScaledLoad { load: unit, factor }));
    }
    let points: Vec<PointShapes> = model.points.iter().map(|(_, point)| point.clone()).collect();
    let setup = model.setup(&fmu.scene, initial);
    Ok(Simulation::new(&Setup {
        loads: &loads,
        physics: &physics,
        end: stop.unwrap_or(0.0).max(setup.end),
        rows: Rows::EverySteps(u64::MAX),
        points: &points,
        ..setup
    })?)
}
