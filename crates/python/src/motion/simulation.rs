//! The class Simulation: a run, row by row or step by step.

use std::sync::{Arc, Mutex, MutexGuard, TryLockError};

use flexframe::columns::part;
use flexframe::dynamics::{self, Crossing, EffectMap, Event, Observation, Setup, StepError};
use flexframe::failure::{Details, Kind};
use flexframe::model::StartError;
use flexframe::results::Metadata;
use flexframe::row::BodyRow;
use flexframe::run::{RunBody, RunError, Watch};
use pyo3::exceptions::{PyRuntimeError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::body::Body;
use crate::errors::{add_note, exception, exception_of, wrong_input};
use crate::motion::faults::Faults;
use crate::motion::load::{listed, load_of};
use crate::motion::seen::Points;
use crate::motion::state::{changed, to_dict};
use crate::rows::results::{Occurred, Rows};
use crate::rows::row::Row;
use crate::scene::Scene;
use crate::threads::{detached, in_pool};
use crate::values::numbers::described;

/// Steps between two looks at signals.
const STEPS_PER_LOOK: u64 = 4096;
/// Times closer than this part of the end are one.
const SAME: f64 = 1e-12;

/// Where a simulation has come to.
#[pyclass(frozen, module = "flexframe")]
pub(crate) struct Reached {
    /// A "row" that is due, an "event", the "stop" of `advance_to`, the end of a "step", or the "end" of the run.
    #[pyo3(get)]
    kind: &'static str,
    /// Name of the event.
    #[pyo3(get)]
    event: Option<String>,
    /// Time.
    #[pyo3(get)]
    time: f64,
    /// Unit of the time.
    unit: String,
}

#[pymethods]
impl Reached {
    fn __repr__(&self) -> String {
        match &self.event {
            Some(event) => format!("Reached(event {event:?} at {} {})", self.time, self.unit),
            None => format!("Reached({} at {} {})", self.kind, self.time, self.unit),
        }
    }
}

/// A run of a body and its scene, with more loads. As an iterator it yields the rows from where it is.
///
/// An exception of a law ends the step: the simulation stays where it was before it, and may go on. One of an event
/// ends the run at the end of the step. Ctrl-C raises KeyboardInterrupt within some thousand steps, and the simulation
/// may go on.
///
/// With laws, the effects translation, rotation, gravity, damping, deformed inertia and Coriolis are on unless the
/// scene switches them off, and there are no reactions of single supports. `run` watches whether the motion leaves the
/// range of the model, such as a spin beyond the critical one, and raises RefusedError; `advance`, `advance_to` and
/// iteration do not.
///
/// With `scene`, the run is of this scene in the place of the body's own: other loads, another start, other effects or
/// steps of the same body, whose modes are not searched again. What follows from the loads, such as static shapes, is
/// solved for where it is not in the cache. A scene of another body, or one that holds it otherwise or asks for other
/// modes, raises InputError.
#[pyclass(frozen, module = "flexframe")]
pub(crate) struct Simulation {
    body: Py<Body>,
    metadata: Arc<Metadata>,
    effects: EffectMap<bool>,
    faults: Faults,
    running: Mutex<Running>,
}

struct Running {
    simulation: dynamics::Simulation,
    /// True if the row at the start has been given, or a step been tried.
    begun: bool,
    /// True if the state has been set since the last try of a step, and no run has given its row.
    is_set: bool,
    row: Observation,
}

impl Simulation {
    /// The run, of which one thing is asked at a time.
    fn running(&self) -> PyResult<MutexGuard<'_, Running>> {
        self.running.try_lock().map_err(|error| match error {
            TryLockError::WouldBlock => PyRuntimeError::new_err(
                "the simulation is in the midst of a step; a law and an event see the motion that they are given, and \
                 another thread waits until the step is done",
            ),
            TryLockError::Poisoned(_) => {
                PyRuntimeError::new_err("the simulation has failed in the midst of a step; start another")
            }
        })
    }

    /// Goes on to the next row, event or stop, or so many tries of a step. Looks at signals now and then.
    fn go_on(
        &self,
        py: Python<'_>,
        running: &mut Running,
        max_steps: u64,
        mut watch: Option<&mut Watch<'_>>,
    ) -> PyResult<dynamics::Reached> {
        let mut left = max_steps;
        loop {
            // Before the steps: what they come to is then returned in any case, and no row or event is lost.
            py.check_signals()?;
            (running.begun, running.is_set) = (true, false);
            let steps = left.min(STEPS_PER_LOOK);
            let simulation = &mut running.simulation;
            let reached = detached(py, || match &mut watch {
                Some(watch) => simulation.advance_watched(steps, |moment| watch.look(moment)),
                None => simulation.advance(steps),
            })?;
            if reached.is_err() {
                // The next step is to start where the motion is.
                simulation.set_stop_time(None);
            }
            let reached = self.or_fault(py, reached)?;
            left -= steps;
            if reached != dynamics::Reached::Between || left == 0 {
                return Ok(reached);
            }
            if watch.as_ref().is_some_and(|watch| watch.refusal().is_some()) {
                return Ok(reached);
            }
        }
    }

    /// The exception of a law or an event, or else the error of the step.
    fn or_fault<T>(&self, py: Python<'_>, result: Result<T, StepError>) -> PyResult<T> {
        match self.faults.take() {
            Some(fault) => Err(fault),
            None => result.map_err(|error| step_error(py, &error)),
        }
    }

    /// The row of the time that has been reached.
    fn row(&self, py: Python<'_>, running: &mut Running) -> PyResult<Row> {
        let Running { simulation, row, .. } = running;
        let observed = detached(py, || simulation.observe(row))?;
        self.or_fault(py, observed)?;
        Row::new(row, self.body.get().model(), &self.metadata)
    }

    fn reached(&self, running: &Running, reached: dynamics::Reached) -> Reached {
        let simulation = &running.simulation;
        let (kind, event) = match reached {
            dynamics::Reached::Event(number) => {
                ("event", simulation.event(number).map(|event| event.name().to_owned()))
            }
            dynamics::Reached::Stop => ("stop", None),
            dynamics::Reached::Row => ("row", None),
            dynamics::Reached::End => ("end", None),
            _ => ("step", None),
        };
        Reached { kind, event, time: simulation.time(), unit: self.metadata.units.time.clone() }
    }

    /// Refuses to go on from the end.
    fn refuse_at_end(&self, py: Python<'_>, running: &Running) -> PyResult<()> {
        if !running.simulation.is_over() {
            return Ok(());
        }
        let message = format!(
            "the run is at its end, time {}; take a scene with a later `time.end`, or set the state to an earlier time",
            running.simulation.end()
        );
        Err(exception_of(py, Kind::Run, &message, &Details::default()))
    }

    /// All rows from here to the end, into `rows`.
    fn follow(
        &self,
        py: Python<'_>,
        running: &mut Running,
        watch: &mut Watch<'_>,
        rows: &mut Rows,
        events: &mut Vec<Occurred>,
    ) -> PyResult<()> {
        let model = self.body.get().model();
        let mut row = flexframe::row::Row { time: 0.0, bodies: vec![BodyRow::new(model)], joints: Vec::new() };
        let mut record = |running: &mut Running, watch: &mut Watch<'_>| -> PyResult<()> {
            for body in &mut row.bodies {
                let observed = detached(py, || running.simulation.observe(&mut body.motion))?;
                self.or_fault(py, observed)?;
                in_pool(|| body.complete(model))?;
                row.time = body.time;
                watch.observe(body).map_err(|error| exception(py, &error))?;
            }
            rows.push(&row, &self.metadata);
            Ok(())
        };
        if !running.begun || running.is_set {
            record(running, watch)?;
            (running.begun, running.is_set) = (true, false);
        }
        while !running.simulation.is_over() {
            let reached = self.go_on(py, running, u64::MAX, Some(watch));
            // A step that fails after the model has come to mean nothing fails for that.
            if let Some((time, refusal)) = watch.refusal() {
                let message = format!("at time {time:.6}: {refusal}");
                return Err(exception_of(py, Kind::Refused, &message, &Details::default()));
            }
            match reached? {
                dynamics::Reached::Row => record(running, watch)?,
                dynamics::Reached::Event(number) => {
                    let name =
                        running.simulation.event(number).map_or_else(String::new, |event| event.name().to_owned());
                    events.push((name, running.simulation.time()));
                }
                dynamics::Reached::End => break,
                _ => {}
            }
        }
        Ok(())
    }
}

fn step_error(py: Python<'_>, error: &StepError) -> PyErr {
    exception(py, &flexframe::run::RunFailure::Step(error.clone()))
}

#[pymethods]
impl Simulation {
    #[new]
    #[pyo3(signature = (body, loads=None, *, scene=None))]
    fn new(
        py: Python<'_>,
        body: Py<Body>,
        loads: Option<Bound<'_, PyAny>>,
        scene: Option<Py<Scene>>,
    ) -> PyResult<Self> {
        let body = match scene {
            Some(scene) => Py::new(py, body.get().of_scene(py, scene)?)?,
            None => body,
        };
        let (model, scene) = (body.get().model().clone(), body.get().scene_of().clone());
        let of_run = [RunBody { scene: &scene, model: &model }];
        let metadata = flexframe::run::metadata(&of_run).ok_or_else(|| exception(py, &RunError::NoBody))?;
        let points: Points = Arc::new(model.points.clone());
        let faults = Faults::default();
        let mut laws = Vec::new();
        for load in listed(loads)? {
            laws.push(load_of(&load, &points, model.body.flexible(), &faults)?);
        }
        let mut without_supports = false;
        let (physics, mut all, damping_ratios) = if laws.is_empty() {
            (model.physics.clone(), model.loads().to_vec(), model.damping_ratios().to_vec())
        } else {
            // What each of several supports does would have to know the laws.
            without_supports = true;
            in_pool(|| model.under_unknown_forces(&scene))?
        };
        all.extend(laws);
        let bodies = metadata.bodies.into_iter().map(|mut body| {
            if without_supports {
                body.parts.retain(|has| has != part::SUPPORTS);
                body.support_names.clear();
            }
            body.model.damping_ratios.clone_from(&damping_ratios);
            body
        });
        let metadata = Arc::new(Metadata { bodies: bodies.collect(), ..metadata });
        if let Some(refusal) = model.refusal.filter(|_| scene.effects.refuse) {
            return Err(exception(py, &StartError::from(refusal)));
        }
        let simulation = detached(py, || {
            let observed: Vec<_> = points.iter().map(|(_, point)| point.clone()).collect();
            let initial = model.initial(&scene);
            dynamics::Simulation::new(&Setup {
                damping_ratios: &damping_ratios,
                loads: &all,
                points: &observed,
                physics: &physics,
                ..model.setup(&scene, &initial)
            })
        })?;
        if let Some(fault) = faults.take() {
            return Err(fault);
        }
        let mut simulation = simulation.map_err(|error| {
            let source = Box::new(StartError::from(error));
            exception(py, &RunError::Setup { scene: scene.path.clone(), source })
        })?;
        simulation.watch(Arc::new(Mutex::new(EndAtFault(faults.clone()))));
        let row = Observation::new(model.body.flexible(), points.len());
        let effects = physics.effects;
        let running = Mutex::new(Running { simulation, begun: false, is_set: false, row });
        Ok(Self { body, metadata, effects, faults, running })
    }

    /// The body, with the scene that is run.
    #[getter]
    fn body(&self, py: Python<'_>) -> Py<Body> {
        self.body.clone_ref(py)
    }

    /// Time that has been reached.
    #[getter]
    fn time(&self) -> PyResult<f64> {
        Ok(self.running()?.simulation.time())
    }

    /// Time at the end.
    #[getter]
    fn end(&self) -> PyResult<f64> {
        Ok(self.running()?.simulation.end())
    }

    /// True if there is nothing more to come, neither a step nor a row.
    #[getter]
    fn done(&self) -> PyResult<bool> {
        Ok(self.running()?.simulation.is_over())
    }

    /// Counts of its work: "steps", "rejected_steps", "evaluations".
    #[getter]
    fn stats<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let stats = self.running()?.simulation.stats();
        let out = PyDict::new(py);
        out.set_item("steps", stats.accepted)?;
        out.set_item("rejected_steps", stats.rejected)?;
        out.set_item("evaluations", stats.evaluations)?;
        Ok(out)
    }

    /// Goes on to the end, and gives the rows from here; events are passed, and listed. Where it fails, the rows before
    /// are in the attribute `results` of the exception.
    fn run<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let mut running = self.running()?;
        self.refuse_at_end(py, &running)?;
        let (model, scene) = (self.body.get().model(), self.body.get().scene_of());
        let initial = model.initial(scene);
        let mut watch = Watch::new(scene, model, &initial, self.effects).map_err(|error| exception(py, &error))?;
        let (mut rows, mut events) = (Rows::new(&self.metadata), Vec::new());
        let followed = self.follow(py, &mut running, &mut watch, &mut rows, &mut events);
        match followed {
            Ok(()) => {
                let warnings =
                    watch.finish(running.simulation.exchanged(), running.simulation.stats().longest).warnings;
                let metadata = Metadata { warnings, ..(*self.metadata).clone() };
                rows.into_results(py, &metadata, true, &events)
            }
            Err(error) => {
                // A class without room for them has them not; whatever fails here, the error is told.
                if let Ok(results) = rows.into_results(py, &self.metadata, false, &events) {
                    let _ = error.value(py).setattr("results", results);
                }
                Err(error)
            }
        }
    }

    /// Goes on to the next row or event, or so many tries of a step.
    #[pyo3(signature = (steps=None))]
    fn advance(&self, py: Python<'_>, steps: Option<u64>) -> PyResult<Reached> {
        let mut running = self.running()?;
        self.refuse_at_end(py, &running)?;
        if steps == Some(0) {
            return Err(wrong_input(py, "steps", "0", "1 or more", "leave it out to go on to the next row"));
        }
        let reached = self.go_on(py, &mut running, steps.unwrap_or(u64::MAX), None)?;
        Ok(self.reached(&running, reached))
    }

    /// Goes on to a time, past rows, or to an event before it. The time is later than now by more than 1e-12 of the
    /// end.
    fn advance_to(&self, py: Python<'_>, time: f64) -> PyResult<Reached> {
        let mut running = self.running()?;
        self.refuse_at_end(py, &running)?;
        let (now, end) = (running.simulation.time(), running.simulation.end());
        // The run knows no time between that it could stop at.
        if !(time - now > SAME * end && time <= end) {
            let expected = format!("a time after {now}, up to the end at {end}");
            let help = "name a time within the run; a later end is `time.end` of the scene";
            return Err(wrong_input(py, "time", &time.to_string(), &expected, help));
        }
        running.simulation.set_stop_time(Some(time));
        let reached = loop {
            match self.go_on(py, &mut running, u64::MAX, None) {
                Ok(dynamics::Reached::Row) => {}
                other => break other,
            }
        };
        if !matches!(reached, Ok(dynamics::Reached::Stop)) {
            running.simulation.set_stop_time(None);
        }
        Ok(self.reached(&running, reached?))
    }

    /// Stops where a function of the row passes through zero, on the far side to rounding.
    #[pyo3(signature = (name, function, *, crossing="any"))]
    fn add_event(&self, name: String, function: &Bound<'_, PyAny>, crossing: &str) -> PyResult<()> {
        let py = function.py();
        if !function.is_callable() {
            let found = function.get_type().name()?;
            return Err(PyTypeError::new_err(format!("an event is a function of a row; found {found}")));
        }
        let crossing = match crossing {
            "rising" => Crossing::Rising,
            "falling" => Crossing::Falling,
            "any" => Crossing::Any,
            other => {
                let (found, expected) = (format!("`{other}`"), "`rising`, `falling` or `any`");
                return Err(wrong_input(py, "crossing", &found, expected, "name the way through zero that counts"));
            }
        };
        let mut running = self.running()?;
        let event = self.event(name, function, crossing);
        let simulation = &mut running.simulation;
        let added = detached(py, || simulation.add_event(event))?;
        self.or_fault(py, added).map(|_| ())
    }

    /// The motion at the time that has been reached.
    fn observe(&self, py: Python<'_>) -> PyResult<Row> {
        self.row(py, &mut *self.running()?)
    }

    /// The state that has been reached: time, attitude (quaternion), origin, velocity of the origin, angular_velocity
    /// (body axes), modal_displacement, modal_velocity.
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let state = self.running()?.simulation.state().map_err(|error| step_error(py, &error))?;
        to_dict(py, &state)
    }

    /// Goes on from another state; keys that are not given stay as they are. Work and balances are counted from there.
    /// `run` then begins with the row of this state; an iteration goes on to the next row.
    fn set_state(&self, py: Python<'_>, state: &Bound<'_, PyDict>) -> PyResult<()> {
        let mut running = self.running()?;
        let now = running.simulation.state().map_err(|error| step_error(py, &error))?;
        let state = changed(now, state)?;
        let end = running.simulation.end();
        if !(0.0..=end).contains(&state.time) {
            let help = "take a scene with a later `time.end`";
            let expected = format!("a time from 0 to the end at {end}");
            return Err(wrong_input(py, "state[\"time\"]", &state.time.to_string(), &expected, help));
        }
        let simulation = &mut running.simulation;
        let set = detached(py, || simulation.set_state(&state))?;
        if let Some(fault) = self.faults.take() {
            return Err(fault);
        }
        set.map_err(|error| exception(py, &StartError::from(error)))?;
        // An iteration goes on to the next row: it may set the state at every one.
        // A row that is due here shows the new state.
        running.is_set = !running.simulation.row_is_due();
        Ok(())
    }

    fn __iter__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __next__(&self, py: Python<'_>) -> PyResult<Option<Row>> {
        let mut running = self.running()?;
        if !running.begun {
            running.begun = true;
            return self.row(py, &mut running).map(Some);
        }
        while !running.simulation.is_over() {
            if self.go_on(py, &mut running, u64::MAX, None)? == dynamics::Reached::Row {
                return self.row(py, &mut running).map(Some);
            }
        }
        Ok(None)
    }

    fn __repr__(&self) -> String {
        match self.running() {
            Ok(running) => {
                let (now, end) = (running.simulation.time(), running.simulation.end());
                format!("Simulation({:?}: time {now} of {end} {})", self.metadata.title, self.metadata.units.time)
            }
            Err(_) => "Simulation(in the midst of a step)".to_owned(),
        }
    }
}

impl Simulation {
    fn event(&self, name: String, function: &Bound<'_, PyAny>, crossing: Crossing) -> Event {
        let (body, metadata, faults) = (self.body.get().model().clone(), self.metadata.clone(), self.faults.clone());
        let (function, known) = (function.clone().unbind(), name.clone());
        Event::new(name, crossing, move |now: &Observation| {
            if faults.any() {
                return f64::NAN;
            }
            let value = Row::new(now, &body, &metadata)
                .and_then(|row| Python::attach(|py| value_of_event(function.bind(py), &known, row)));
            value.unwrap_or_else(|error| {
                Python::attach(|py| add_note(py, &error, &format!("in the event `{known}` at time {}", now.time)));
                faults.put(error);
                f64::NAN
            })
        })
    }
}

/// The value of an event's function.
fn value_of_event(function: &Bound<'_, PyAny>, name: &str, row: Row) -> PyResult<f64> {
    let value = function.call1((row,))?;
    let refuse = |found: &str| {
        let help = "return a function of the row that passes through zero";
        wrong_input(function.py(), &format!("the event `{name}`"), found, "a finite number", help)
    };
    let number: f64 = value.extract().map_err(|_| refuse(&described(&value)))?;
    if number.is_finite() { Ok(number) } else { Err(refuse(&number.to_string())) }
}

/// Ends a run at the end of a step in which a law has raised, so that no row is lost: where a drive jumps, laws are asked
/// once more when the step itself is done.
struct EndAtFault(Faults);

impl dynamics::Observer for EndAtFault {
    fn step(&mut self, now: &mut dynamics::StepEnd<'_>) -> Result<(), StepError> {
        match self.0.any() {
            true => Err(StepError::NotFinite { time: now.motion().time(), what: "a law" }),
            false => Ok(()),
        }
    }
}
