//! The class MarkerForce: a force and a moment between two markers, whose law is a function of Python; and RelativeMotion, what it sees.

use std::fmt;
use std::sync::Arc;

use flexframe::dynamics::{self, MarkerLaw};
use flexframe::motion::MarkerForces;
use flexframe::nalgebra::Vector3;
use flexframe::scene;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::errors::wrong_input;
use crate::motion::faults::Faults;
use crate::motion::load::Law;
use crate::values::arrays::matrix;
use crate::values::numbers::{described, vector};

/// A force and a moment on the second of two markers, and the same the other way round on the first, by a law: a function of the time
/// and the RelativeMotion of the second marker that returns the force, or the force and the moment, in the axes of the first.
///
/// `between` names the markers as `between` of a scene does: "BODY.MARKER", "ground.MARKER" or "ground", which is where the other marker
/// is at the start. Their axes are those of a bushing there. The law is evaluated many times a step, and must depend on nothing but
/// these. `discontinuities` are times at which it or its rate jumps, so that steps end there.
#[pyclass(frozen, module = "flexframe")]
pub(crate) struct MarkerForce {
    between: [String; 2],
    law: Law,
}

#[pymethods]
impl MarkerForce {
    #[new]
    #[pyo3(signature = (between, law, *, name=None, discontinuities=Vec::new()))]
    fn new(
        between: [String; 2],
        law: &Bound<'_, PyAny>,
        name: Option<String>,
        discontinuities: Vec<f64>,
    ) -> PyResult<Self> {
        Ok(Self { between, law: Law::new(law, name, discontinuities, None)? })
    }

    fn __repr__(&self) -> String {
        format!("MarkerForce({:?}, {})", self.between, self.law.name)
    }
}

impl MarkerForce {
    /// The law between the markers of a system.
    pub(crate) fn of(&self, py: Python<'_>, system: &scene::System, faults: &Faults) -> PyResult<MarkerForces> {
        let ends = system.ends();
        let names: Vec<String> = ends.iter().map(|end| system.name_of(*end)).collect();
        let end = |name: &String| match names.iter().position(|known| known == name) {
            Some(number) => Ok(ends[number]),
            None => {
                let help = "name markers of the bodies, [bodies.NAME.markers], or of the ground, [ground.markers]";
                Err(wrong_input(py, "between", &format!("`{name}`"), &format!("one of {}", names.join(", ")), help))
            }
        };
        let between = [end(&self.between[0])?, end(&self.between[1])?];
        if between[0] == between[1] || between.iter().all(|end| end.body().is_none()) {
            let found = format!("`{}` and `{}`", self.between[0], self.between[1]);
            let help = "let the force act between two bodies, or between one and the ground";
            return Err(wrong_input(py, "between", &found, "two markers, of which one is on a body", help));
        }
        let law = PythonLaw {
            function: self.law.function.clone_ref(py),
            name: self.law.name.clone(),
            discontinuities: self.law.discontinuities.clone(),
            faults: faults.clone(),
        };
        Ok(MarkerForces { name: self.law.name.clone(), between, law: Arc::new(law) })
    }
}

/// The motion of the second of two markers as the first sees it, in the axes of the first. Arrays are copies.
#[pyclass(frozen, module = "flexframe")]
pub(crate) struct RelativeMotion(dynamics::RelativeMotion);

#[pymethods]
impl RelativeMotion {
    /// Position of the second marker from the first (3).
    #[getter]
    fn position<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.0.position.as_slice())
    }

    /// Rate of the position (3).
    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.0.velocity.as_slice())
    }

    /// Matrix that takes components along the axes of the second marker to those along the axes of the first (3x3).
    #[getter]
    fn rotation<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        matrix(py, &self.0.axes)
    }

    /// Angular velocity of the second marker less that of the first (3).
    #[getter]
    fn angular_velocity<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.0.omega.as_slice())
    }

    fn __repr__(&self) -> String {
        let [x, y, z] = self.0.position.into();
        format!("RelativeMotion(position [{x}, {y}, {z}])")
    }
}

struct PythonLaw {
    function: Py<PyAny>,
    name: String,
    discontinuities: Vec<f64>,
    faults: Faults,
}

impl PythonLaw {
    /// The force and the moment that the function returns.
    fn returned(&self, value: &Bound<'_, PyAny>) -> PyResult<[Vector3<f64>; 2]> {
        let [force, moment] = ["force", "moment"].map(|of| format!("the {of} of the law `{}`", self.name));
        match value.len() {
            Ok(3) => Ok([vector(value, &force)?, Vector3::zeros()]),
            Ok(2) => Ok([vector(&value.get_item(0)?, &force)?, vector(&value.get_item(1)?, &moment)?]),
            _ => {
                let (what, expected) = (format!("the law `{}`", self.name), "a force, or a force and a moment");
                let help = "return three numbers, or two times three";
                Err(wrong_input(value.py(), &what, &described(value), expected, help))
            }
        }
    }
}

impl fmt::Debug for PythonLaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "PythonLaw({})", self.name)
    }
}

impl MarkerLaw for PythonLaw {
    fn force_and_moment(&self, [time, _]: [f64; 2], motion: &dynamics::RelativeMotion) -> [Vector3<f64>; 2] {
        let asked = self.faults.ask(
            || format!("in the law `{}` at time {time}", self.name),
            |py| self.returned(&self.function.bind(py).call1((time, RelativeMotion(*motion)))?),
        );
        asked.unwrap_or([Vector3::repeat(f64::NAN); 2])
    }

    fn discontinuities(&self) -> Vec<f64> {
        self.discontinuities.clone()
    }
}
