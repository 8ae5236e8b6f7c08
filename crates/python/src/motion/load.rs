//! The classes Force and ModalForce: loads whose law is a function of Python.

use std::sync::Arc;

use flexframe::dynamics::{Applied, Kinematics, LoadFn, SharedLoad};
use flexframe::nalgebra::Vector3;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use crate::errors::wrong_input;
use crate::motion::faults::Faults;
use crate::motion::law::Law;
use crate::motion::seen::{Motion, Points, point_number};
use crate::values::numbers::{numbers, vector};

/// The entries of a list of loads.
pub(crate) fn listed(loads: Option<Bound<'_, PyAny>>) -> PyResult<Vec<Bound<'_, PyAny>>> {
    let Some(loads) = loads else { return Ok(Vec::new()) };
    let found = loads.get_type().name()?;
    loads.extract().map_err(|_| {
        PyTypeError::new_err(format!(
            "loads: found an object of type {found}, expected a list of Force and ModalForce\n = write one load as a list of one: \
             Simulation(body, [load])"
        ))
    })
}

impl Law {
    /// The load whose law is `act`: it applies what the function gives, or keeps what it raises.
    fn load(
        &self,
        py: Python<'_>,
        faults: &Faults,
        evaluate: impl Fn(&Bound<'_, PyAny>, &Kinematics<'_>) -> PyResult<Vec<f64>> + Send + Sync + 'static,
        apply: impl Fn(Option<&[f64]>, &Kinematics<'_>, &mut Applied<'_>) + Send + Sync + 'static,
    ) -> SharedLoad {
        let (function, name, faults) = (self.function.clone_ref(py), self.name.clone(), faults.clone());
        let law = move |motion: &Kinematics<'_>, applied: &mut Applied<'_>| {
            let note = || format!("in the load `{name}` at time {}", motion.time);
            let value = faults.ask(note, |py| evaluate(function.bind(py), motion));
            apply(value.as_deref(), motion, applied);
        };
        let load = LoadFn::new(self.name.clone(), law).with_discontinuities(self.discontinuities.clone());
        match self.longest_step {
            Some(step) => Arc::new(load.with_longest_step(step)),
            None => Arc::new(load),
        }
    }
}

/// A force at a point of the scene, by a law: a function of the motion that returns three components.
///
/// They are global, or in body axes with `frame="body"`. The law is evaluated several times a step, and must depend on
/// nothing but the motion. `discontinuities` are times at which it or its rate jumps, so that steps end there; `longest_step`
/// is the longest step that sees it as it is.
#[pyclass(frozen, module = "flexframe")]
pub(crate) struct Force {
    point: String,
    /// True if the law gives body components, of a force that turns with the body frame.
    follows: bool,
    law: Law,
}

#[pymethods]
impl Force {
    #[new]
    #[pyo3(signature = (point, law, *, frame="global", name=None, discontinuities=Vec::new(), longest_step=None))]
    fn new(
        point: String,
        law: &Bound<'_, PyAny>,
        frame: &str,
        name: Option<String>,
        discontinuities: Vec<f64>,
        longest_step: Option<f64>,
    ) -> PyResult<Self> {
        let follows = match frame {
            "global" => false,
            "body" => true,
            other => {
                let (found, help) = (format!("`{other}`"), "name the axes of the components that the law gives");
                return Err(wrong_input(law.py(), "frame", &found, "`global` or `body`", help));
            }
        };
        Ok(Self { point, follows, law: Law::new(law, name, discontinuities, longest_step)? })
    }

    fn __repr__(&self) -> String {
        format!("Force({:?}, {})", self.point, self.law.name)
    }
}

/// Forces on the modal coordinates, by a law that returns nf of them. They have no resultant. Otherwise as Force.
#[pyclass(frozen, module = "flexframe")]
pub(crate) struct ModalForce {
    law: Law,
}

#[pymethods]
impl ModalForce {
    #[new]
    #[pyo3(signature = (law, *, name=None, discontinuities=Vec::new(), longest_step=None))]
    fn new(
        law: &Bound<'_, PyAny>,
        name: Option<String>,
        discontinuities: Vec<f64>,
        longest_step: Option<f64>,
    ) -> PyResult<Self> {
        Ok(Self { law: Law::new(law, name, discontinuities, longest_step)? })
    }

    fn __repr__(&self) -> String {
        format!("ModalForce({})", self.law.name)
    }
}

impl Force {
    fn load(&self, py: Python<'_>, points: &Points, faults: &Faults) -> PyResult<SharedLoad> {
        let number = point_number(py, points, &self.point)?;
        let (seen, point, follows) = (points.clone(), points[number].1.clone(), self.follows);
        let what = format!("the force of the law `{}`", self.law.name);
        let evaluate = move |law: &Bound<'_, PyAny>, motion: &Kinematics<'_>| {
            let force = law.call1((Motion::new(motion, &seen, Some(number)),))?;
            Ok(vector(&force, &what)?.as_slice().to_vec())
        };
        let apply = move |force: Option<&[f64]>, motion: &Kinematics<'_>, applied: &mut Applied<'_>| {
            let force = force.map_or_else(|| Vector3::repeat(f64::NAN), Vector3::from_column_slice);
            let force_body = if follows { force } else { motion.body_from_global * force };
            applied.force(&point, &force_body);
        };
        Ok(self.law.load(py, faults, evaluate, apply))
    }
}

impl ModalForce {
    fn load(&self, py: Python<'_>, points: &Points, flexible: usize, faults: &Faults) -> PyResult<SharedLoad> {
        if flexible == 0 {
            let help = "take a Force at a point, or a body with modes";
            return Err(wrong_input(py, "ModalForce", "a rigid body", "a body with flexible modes", help));
        }
        let seen = points.clone();
        let what = format!("the modal forces of the law `{}`", self.law.name);
        let evaluate = move |law: &Bound<'_, PyAny>, motion: &Kinematics<'_>| {
            numbers(&law.call1((Motion::new(motion, &seen, None),))?, flexible, &what)
        };
        let apply = move |forces: Option<&[f64]>, _: &Kinematics<'_>, applied: &mut Applied<'_>| match forces {
            Some(forces) => forces.iter().enumerate().for_each(|(k, force)| applied.modal_force(k, *force)),
            None => applied.modal_force(0, f64::NAN),
        };
        Ok(self.law.load(py, faults, evaluate, apply))
    }
}

/// The load of a Force or a ModalForce on a body with these points and this number of modes.
pub(crate) fn load_of(
    object: &Bound<'_, PyAny>,
    points: &Points,
    flexible: usize,
    faults: &Faults,
) -> PyResult<SharedLoad> {
    let py = object.py();
    if let Ok(force) = object.cast::<Force>() {
        return force.get().load(py, points, faults);
    }
    if let Ok(force) = object.cast::<ModalForce>() {
        return force.get().load(py, points, flexible, faults);
    }
    let found = object.get_type().name()?;
    Err(PyTypeError::new_err(format!("a load is a Force or a ModalForce; found {found}")))
}
