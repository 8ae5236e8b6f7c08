//! The class Simulation: a run, row by row or step by step.

use std::sync::{Arc, Mutex, MutexGuard, TryLockError};

use diagnostic::Kind;
use flexframe::columns::part;
use flexframe::dynamics::{
    self, Crossing, EffectMap, Event, Island, JointObservation, Observation, StepError, SystemObservation,
};
use flexframe::model::{Model, StartError};
use flexframe::motion::{BodyForces, StartSettings, begin};
use flexframe::results::Metadata;
use flexframe::row::BodyRow;
use flexframe::run::{RunBody, RunError, Watch};
use pyo3::exceptions::{PyRuntimeError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::body::Body;
use crate::errors::{add_note, exception, exception_of, wrong_input};
use crate::motion::faults::Faults;
use crate::motion::joint_equation::JointEquation;
use crate::motion::joint_force::JointForce;
use crate::motion::load::{listed, load_of};
use crate::motion::marker_force::MarkerForce;
use crate::motion::seen::Points;
use crate::motion::state::{changed, to_dict};
use crate::rows::results::{Occurred, Rows};
use crate::rows::row::Row;
use crate::scene::Scene;
use crate::system::System;
use crate::threads::{detached, in_pool};
use crate::values::numbers::{described, number};

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
/// For a System, `loads` is a dict from names of bodies to lists, `joint_forces` a list of JointForce, `joint_equations` one of
/// JointEquation, `marker_forces` one of MarkerForce, and states are dicts from names of bodies; all bodies are stepped together, also
/// those that nothing ties.
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
    /// The Body or the System.
    of: Py<PyAny>,
    bodies: Vec<Moved>,
    /// Models of the bodies.
    models: Vec<Arc<Model>>,
    metadata: Arc<Metadata>,
    faults: Faults,
    running: Mutex<Running>,
}

/// A body of a run.
struct Moved {
    scene: Arc<flexframe::scene::Body>,
    model: Arc<Model>,
    effects: EffectMap<bool>,
}

struct Running {
    /// All bodies are in one.
    island: Island,
    /// True if the row at the start has been given, or a step been tried.
    begun: bool,
    /// True if the state has been set since the last try of a step, and no run has given its row.
    is_set: bool,
    row: flexframe::row::Row,
}

impl Running {
    /// Observes the motion at the time that it has come to.
    fn observe(&mut self) -> Result<(), StepError> {
        let Self { island, row, .. } = self;
        row.time = island.motion.time();
        island.observe(None, row.bodies.iter_mut().map(|body| &mut body.motion), &mut row.joints)
    }
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

    /// Goes on to the next row, event or stop, or for at most `tries` tries of a step. Looks at signals now and then.
    fn go_on(
        &self,
        py: Python<'_>,
        running: &mut Running,
        max_steps: u64,
        mut watches: Option<&mut [Watch<'_>]>,
    ) -> PyResult<dynamics::Reached> {
        let mut left = max_steps;
        loop {
            // Before the steps: what they come to is then returned in any case, and no row or event is lost.
            py.check_signals()?;
            (running.begun, running.is_set) = (true, false);
            let steps = left.min(STEPS_PER_LOOK);
            let motion = &mut running.island.motion;
            let reached = detached(py, || match &mut watches {
                Some(watches) => motion.advance_watched(steps, |body, moment| watches[body].look(moment)),
                None => motion.advance(steps),
            })?;
            if reached.is_err() {
                // The next step is to start where the motion is.
                motion.set_stop_time(None);
            }
            let reached = self.or_fault(py, reached)?;
            left -= steps;
            if reached != dynamics::Reached::Between || left == 0 {
                return Ok(reached);
            }
            if watches.as_ref().is_some_and(|watches| watches.iter().any(|watch| watch.refusal().is_some())) {
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
        let observed = detached(py, || running.observe())?;
        self.or_fault(py, observed)?;
        Row::new(running.row.clone(), &self.models, &self.metadata)
    }

    fn reached(&self, running: &Running, reached: dynamics::Reached) -> Reached {
        let motion = &running.island.motion;
        let (kind, event) = match reached {
            dynamics::Reached::Event(number) => ("event", motion.event(number).map(|event| event.name().to_owned())),
            dynamics::Reached::Stop => ("stop", None),
            dynamics::Reached::Row => ("row", None),
            dynamics::Reached::End => ("end", None),
            _ => ("step", None),
        };
        Reached { kind, event, time: motion.time(), unit: self.metadata.units.time.clone() }
    }

    /// Refuses to go on from the end.
    fn refuse_at_end(&self, py: Python<'_>, running: &Running) -> PyResult<()> {
        if !running.island.motion.is_over() {
            return Ok(());
        }
        let message = format!(
            "the run is at its end, time {}; take a scene with a later `time.end`, or set the state to an earlier time",
            running.island.motion.end()
        );
        Err(exception_of(py, &message, &Kind::Run.alone()))
    }

    /// All rows from here to the end, into `rows`.
    fn follow(
        &self,
        py: Python<'_>,
        running: &mut Running,
        watches: &mut [Watch<'_>],
        rows: &mut Rows,
        events: &mut Vec<Occurred>,
    ) -> PyResult<()> {
        let mut record = |running: &mut Running, watches: &mut [Watch<'_>]| -> PyResult<()> {
            let observed = detached(py, || running.observe())?;
            self.or_fault(py, observed)?;
            let row = &mut running.row;
            in_pool(|| row.bodies.iter_mut().zip(&self.models).for_each(|(body, model)| body.complete(model)))?;
            for (watch, body) in watches.iter_mut().zip(&row.bodies) {
                watch.observe(body).map_err(|error| exception(py, &error))?;
            }
            rows.push(row, &self.metadata);
            Ok(())
        };
        if !running.begun || running.is_set {
            record(running, watches)?;
            (running.begun, running.is_set) = (true, false);
        }
        while !running.island.motion.is_over() {
            let reached = self.go_on(py, running, u64::MAX, Some(watches));
            // A step that fails after the model has come to mean nothing fails for that.
            if let Some((time, refusal)) = watches.iter().find_map(Watch::refusal) {
                let message = format!("at time {time:.6}: {refusal}");
                return Err(exception_of(py, &message, &Kind::Refused.alone()));
            }
            match reached? {
                dynamics::Reached::Row => record(running, watches)?,
                dynamics::Reached::Event(number) => {
                    let name =
                        running.island.motion.event(number).map_or_else(String::new, |event| event.name().to_owned());
                    events.push((name, running.island.motion.time()));
                }
                dynamics::Reached::End => break,
                _ => {}
            }
        }
        Ok(())
    }
}

/// The bodies of a Body or a System, and what ties them together.
fn bodies_of(of: &Bound<'_, PyAny>) -> PyResult<(Arc<flexframe::scene::Scene>, Vec<Arc<Model>>)> {
    if let Ok(body) = of.cast::<Body>() {
        let given: flexframe::scene::Body = (**body.get().scene_of()).clone();
        return Ok((Arc::new(given.into()), vec![body.get().model().clone()]));
    }
    if let Ok(system) = of.cast::<System>() {
        return Ok((system.get().whole().clone(), system.get().models().to_vec()));
    }
    let found = of.get_type().name()?;
    Err(PyTypeError::new_err(format!("a simulation is of a Body or of a System; found {found}")))
}

/// The loads of each body: of a Body those of a list, of a System those of a dict by the names of its bodies.
fn loads_of_bodies<'py>(
    py: Python<'py>,
    loads: Option<Bound<'py, PyAny>>,
    bodies: &[flexframe::scene::Body],
    is_system: bool,
) -> PyResult<Vec<Vec<Bound<'py, PyAny>>>> {
    if !is_system {
        return Ok(vec![listed(loads)?]);
    }
    let mut all = vec![Vec::new(); bodies.len()];
    let Some(loads) = loads else { return Ok(all) };
    let Ok(loads) = loads.cast_into::<PyDict>() else {
        let help = "name the body of each list: Simulation(system, {\"arm\": [load]})";
        return Err(wrong_input(py, "loads", "no dict", "a dict from names of bodies to lists of loads", help));
    };
    for (name, loads) in loads {
        let name: String = name.extract()?;
        let number = bodies.iter().position(|body| body.name.as_deref().unwrap_or("body") == name);
        let Some(number) = number else {
            let known: Vec<&str> = bodies.iter().map(|body| body.name.as_deref().unwrap_or("body")).collect();
            let expected = format!("one of {}", known.join(", "));
            return Err(wrong_input(py, "loads", &format!("the key `{name}`"), &expected, "name a body of the scene"));
        };
        all[number] = listed(Some(loads))?;
    }
    Ok(all)
}

fn step_error(py: Python<'_>, error: &StepError) -> PyErr {
    exception(py, error)
}

#[pymethods]
impl Simulation {
    #[new]
    #[pyo3(signature = (body, loads=None, *, joint_forces=None, joint_equations=None, marker_forces=None, scene=None))]
    fn new(
        py: Python<'_>,
        body: Bound<'_, PyAny>,
        loads: Option<Bound<'_, PyAny>>,
        joint_forces: Option<Vec<Py<JointForce>>>,
        joint_equations: Option<Vec<Py<JointEquation>>>,
        marker_forces: Option<Vec<Py<MarkerForce>>>,
        scene: Option<Py<Scene>>,
    ) -> PyResult<Self> {
        let body = match (scene, body.cast::<Body>()) {
            (Some(scene), Ok(body)) => Py::new(py, body.get().of_scene(py, scene)?)?.into_bound(py).into_any(),
            (Some(_), Err(_)) => {
                let help = "make another System of the scene: what takes long is in the cache";
                return Err(wrong_input(py, "scene", "a scene beside a System", "one beside a Body", help));
            }
            (None, _) => body,
        };
        let (system, models) = bodies_of(&body)?;
        let is_system = body.cast::<System>().is_ok();
        let of_models: Vec<&Model> = models.iter().map(|model| &**model).collect();
        let of_run: Vec<RunBody<'_>> =
            system.bodies.iter().zip(&of_models).map(|(body, model)| RunBody { body, model }).collect();
        let mut metadata = flexframe::run::metadata_of_scene(&system, &of_run);
        let mut beginning = StartSettings { together: is_system, ..StartSettings::of(&system, &of_models) };
        let faults = Faults::default();
        let loads = loads_of_bodies(py, loads, &system.bodies, is_system)?;
        for (number, loads) in loads.into_iter().enumerate() {
            let (model, scene) = (&models[number], &system.bodies[number]);
            let points: Points = Arc::new(model.points.clone());
            let laws = loads.iter().map(|load| load_of(load, &points, model.body.flexible(), &faults));
            let laws = laws.collect::<PyResult<Vec<_>>>()?;
            let body = &mut metadata.bodies[number];
            if !laws.is_empty() {
                // What each of several supports does would have to know the laws.
                body.parts.retain(|has| has != part::SUPPORTS);
                body.support_names.clear();
                let (physics, mut all, damping_ratios) = in_pool(|| model.under_unknown_forces(scene))?;
                all.extend(laws);
                beginning.bodies[number] = BodyForces { loads: all, damping_ratios, physics };
            }
            body.model.damping_ratios.clone_from(&beginning.bodies[number].damping_ratios);
        }
        for force in joint_forces.unwrap_or_default() {
            let of = force.get().of(py, &system, &faults)?;
            let parts = &mut metadata.joints[of.joint].parts;
            let acts = match of.along {
                dynamics::Coordinate::Turn => part::TURN_FORCE,
                dynamics::Coordinate::Slide => part::SLIDE_FORCE,
            };
            for part in [part::DRIVE, acts] {
                if !parts.iter().any(|has| has == part) {
                    parts.push(part.to_owned());
                }
            }
            beginning.laws.push(of);
        }
        for equation in joint_equations.unwrap_or_default() {
            beginning.equations.push(equation.get().of(py, &system, &faults)?);
        }
        for force in marker_forces.unwrap_or_default() {
            beginning.marker_laws.push(force.get().of(py, &system, &faults)?);
        }
        let metadata = Arc::new(metadata);
        let begun = detached(py, || begin(&system, &of_models, &beginning))?;
        if let Some(fault) = faults.take() {
            return Err(fault);
        }
        let begun = begun.map_err(|error| exception(py, &RunError::from(error)))?;
        let Some(mut island) = begun.into_islands().into_iter().next() else {
            return Err(PyValueError::new_err("there is no body to run; give one or more"));
        };
        if island.motion.system().is_none() {
            island.motion.watch(Arc::new(Mutex::new(EndAtFault(faults.clone()))));
        }
        let row = flexframe::row::Row {
            time: 0.0,
            bodies: models.iter().map(|model| BodyRow::new(model)).collect(),
            joints: vec![JointObservation::default(); metadata.joints.len()],
        };
        let bodies = system.bodies.iter().zip(&models).zip(beginning.bodies);
        let bodies = bodies.map(|((scene, model), forces)| Moved {
            scene: Arc::new(scene.clone()),
            model: model.clone(),
            effects: forces.physics.effects,
        });
        let bodies = bodies.collect();
        let running = Mutex::new(Running { island, begun: false, is_set: false, row });
        Ok(Self { of: body.unbind(), bodies, models, metadata, faults, running })
    }

    /// The Body with the scene that is run, or the System.
    #[getter]
    fn body(&self, py: Python<'_>) -> Py<PyAny> {
        self.of.clone_ref(py)
    }

    /// Time that has been reached.
    #[getter]
    fn time(&self) -> PyResult<f64> {
        Ok(self.running()?.island.motion.time())
    }

    /// Time at the end.
    #[getter]
    fn end(&self) -> PyResult<f64> {
        Ok(self.running()?.island.motion.end())
    }

    /// True if there is nothing more to come, neither a step nor a row.
    #[getter]
    fn done(&self) -> PyResult<bool> {
        Ok(self.running()?.island.motion.is_over())
    }

    /// Counts of its work: "steps", "rejected_steps", "evaluations".
    #[getter]
    fn stats<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let stats = self.running()?.island.motion.stats();
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
        let initial: Vec<_> = self.bodies.iter().map(|Moved { scene, model, .. }| model.initial(scene)).collect();
        let watches = self.bodies.iter().zip(&initial);
        let watches =
            watches.map(|(Moved { scene, model, effects }, initial)| Watch::new(scene, model, initial, *effects));
        let watches = watches.collect::<Result<Vec<_>, _>>();
        let mut watches = watches.map_err(|error| exception(py, &error))?;
        let (mut rows, mut events) = (Rows::new(&self.metadata), Vec::new());
        let followed = self.follow(py, &mut running, &mut watches, &mut rows, &mut events);
        match followed {
            Ok(()) => {
                let motion = &running.island.motion;
                let longest = motion.stats().longest;
                let warnings = watches.iter_mut().zip(&self.bodies).enumerate().flat_map(|(body, (watch, of))| {
                    let name = of.scene.name.as_ref().filter(|_| self.bodies.len() > 1);
                    let named = move |words: String| name.map_or(words.clone(), |name| format!("body {name}: {words}"));
                    watch.finish(&motion.energies(body), longest).warnings.into_iter().map(named)
                });
                let metadata = Metadata { warnings: warnings.collect(), ..(*self.metadata).clone() };
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

    /// Goes on to the next row or event, or for at most `steps` tries of a step.
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
        let (now, end) = (running.island.motion.time(), running.island.motion.end());
        // The run knows no time between that it could stop at.
        if !(time - now > SAME * end && time <= end) {
            let expected = format!("a time after {now}, up to the end at {end}");
            let help = "name a time within the run; a later end is `time.end` of the scene";
            return Err(wrong_input(py, "time", &time.to_string(), &expected, help));
        }
        running.island.motion.set_stop_time(Some(time));
        let reached = loop {
            match self.go_on(py, &mut running, u64::MAX, None) {
                Ok(dynamics::Reached::Row) => {}
                other => break other,
            }
        };
        if !matches!(reached, Ok(dynamics::Reached::Stop)) {
            running.island.motion.set_stop_time(None);
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
        let seen = self.seen(name.clone(), function);
        let joints = running.row.joints.len();
        let models = self.models.clone();
        let event = Event::of_system(name, crossing, move |now: &SystemObservation| {
            let body = |(motion, model): (&Observation, &Arc<Model>)| {
                let mut body = BodyRow::new(model);
                body.motion.clone_from(motion);
                body
            };
            let bodies = now.bodies.iter().zip(&models).map(body).collect();
            // Laws from outside come last.
            let joints = now.joints.iter().chain(&now.elements).take(joints).copied().collect();
            seen(flexframe::row::Row { time: now.time, bodies, joints })
        });
        let motion = &mut running.island.motion;
        let added = detached(py, || motion.add_event(event))?;
        self.or_fault(py, added).map(|_| ())
    }

    /// The motion at the time that has been reached.
    fn observe(&self, py: Python<'_>) -> PyResult<Row> {
        self.row(py, &mut *self.running()?)
    }

    /// The state that has been reached: time, attitude (quaternion), origin, velocity of the origin, angular_velocity
    /// (body axes), modal_displacement, modal_velocity.
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let states = self.running()?.island.motion.states().map_err(|error| step_error(py, &error))?;
        if let ([state], false) = (&states[..], self.is_system(py)) {
            return to_dict(py, state);
        }
        let out = PyDict::new(py);
        for (state, name) in states.iter().zip(self.names()) {
            out.set_item(name, to_dict(py, state)?)?;
        }
        Ok(out)
    }

    /// Goes on from another state; keys that are not given stay as they are. Work and balances are counted from there.
    /// `run` then begins with the row of this state; an iteration goes on to the next row. Bodies in joints are moved so that
    /// these close.
    fn set_state(&self, py: Python<'_>, state: &Bound<'_, PyDict>) -> PyResult<()> {
        let mut running = self.running()?;
        let mut states = running.island.motion.states().map_err(|error| step_error(py, &error))?;
        if self.is_system(py) {
            let before = states.first().map_or(0.0, |state| state.time);
            for (name, state) in state {
                let name: String = name.extract()?;
                let Some(number) = self.names().position(|known| known == name) else {
                    let expected = format!("one of {}", self.names().collect::<Vec<_>>().join(", "));
                    let help = "change the dict that state() gives, or give some of its keys";
                    return Err(wrong_input(py, "state", &format!("the key `{name}`"), &expected, help));
                };
                let state = state.cast::<PyDict>()?;
                states[number] = changed(states[number].clone(), state)?;
            }
            // The time of one is that of all.
            let time = states.iter().map(|state| state.time).find(|time| *time != before).unwrap_or(before);
            states.iter_mut().for_each(|state| state.time = time);
        } else if let Some(first) = states.first_mut() {
            *first = changed(first.clone(), state)?;
        }
        let (end, time) = (running.island.motion.end(), states.first().map_or(0.0, |state| state.time));
        if !(0.0..=end).contains(&time) {
            let help = "take a scene with a later `time.end`";
            let expected = format!("a time from 0 to the end at {end}");
            return Err(wrong_input(py, "state[\"time\"]", &time.to_string(), &expected, help));
        }
        let motion = &mut running.island.motion;
        let set = detached(py, || motion.set_states(&states))?;
        if let Some(fault) = self.faults.take() {
            return Err(fault);
        }
        set.map_err(|error| exception(py, &StartError::from(error)))?;
        // An iteration goes on to the next row: it may set the state at every one.
        // A row that is due here shows the new state.
        running.is_set = !running.island.motion.row_is_due();
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
        while !running.island.motion.is_over() {
            if self.go_on(py, &mut running, u64::MAX, None)? == dynamics::Reached::Row {
                return self.row(py, &mut running).map(Some);
            }
        }
        Ok(None)
    }

    fn __repr__(&self) -> String {
        match self.running() {
            Ok(running) => {
                let (now, end) = (running.island.motion.time(), running.island.motion.end());
                format!("Simulation({:?}: time {now} of {end} {})", self.metadata.title, self.metadata.units.time)
            }
            Err(_) => "Simulation(in the midst of a step)".to_owned(),
        }
    }
}

impl Simulation {
    fn is_system(&self, py: Python<'_>) -> bool {
        self.of.bind(py).cast::<System>().is_ok()
    }

    /// Names of the bodies.
    fn names(&self) -> impl Iterator<Item = &str> {
        self.bodies.iter().map(|body| body.scene.name.as_deref().unwrap_or("body"))
    }

    /// The function of an event, of a row as it has been observed.
    fn seen(
        &self,
        name: String,
        function: &Bound<'_, PyAny>,
    ) -> impl Fn(flexframe::row::Row) -> f64 + Send + Sync + 'static {
        let (models, metadata, faults) = (self.models.clone(), self.metadata.clone(), self.faults.clone());
        let function = function.clone().unbind();
        move |now| {
            if faults.any() {
                return f64::NAN;
            }
            let time = now.time;
            let value = Row::new(now, &models, &metadata)
                .and_then(|row| Python::attach(|py| value_of_event(function.bind(py), &name, row)));
            value.unwrap_or_else(|error| {
                Python::attach(|py| add_note(py, &error, &format!("in the event `{name}` at time {time}")));
                faults.put(error);
                f64::NAN
            })
        }
    }
}

/// The value of an event's function.
fn value_of_event(function: &Bound<'_, PyAny>, name: &str, row: Row) -> PyResult<f64> {
    let value = function.call1((row,))?;
    let refuse = |found: &str| {
        let help = "return a function of the row that passes through zero";
        wrong_input(function.py(), &format!("the event `{name}`"), found, "a finite number", help)
    };
    let number = number(&value).ok_or_else(|| refuse(&described(&value)))?;
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
