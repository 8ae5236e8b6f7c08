//! The class MarkerForce: a force and a moment between two markers, whose law is a function of Python; and RelativeMotion, what it sees.

use std::sync::Arc;

use flexframe::dynamics::{self, MarkerLaw};
use flexframe::motion::MarkerForces;
use flexframe::nalgebra::Vector3;
use flexframe::scene;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::errors::wrong_input;
use crate::motion::faults::Faults;
use crate::motion::law::{LawInRun, OwnLaw};
use crate::values::arrays::matrix;
use crate::values::numbers::{described, vector};

/// A force and a moment on the second of two markers, and the same the other way round on the first, by a law: a function of the time
/// and the RelativeMotion of the second marker that returns the force, or the force and the moment, in the axes of the first.
///
/// `between` names the markers as `between` of a scene does: "BODY.MARKER", "ground.MARKER" or "ground", which is where the other marker
/// is at the start. Their axes are those of a bushing there. The law is evaluated many times a step, and must depend on nothing but
/// these. `discontinuities` are times at which it or its rate jumps, so that steps end there. `switch` is a function of the same that
/// changes its sign where the law has a kink or a jump, such as the gap of a contact: under a tolerance steps end there.
#[pyclass(frozen, module = "flexframe")]
pub(crate) struct MarkerForce {
    between: [String; 2],
    law: OwnLaw,
}

#[pymethods]
impl MarkerForce {
    #[new]
    #[pyo3(signature = (between, law, *, name=None, discontinuities=Vec::new(), switch=None))]
    fn new(
        between: [String; 2],
        law: &Bound<'_, PyAny>,
        name: Option<String>,
        discontinuities: Vec<f64>,
        switch: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        Ok(Self { between, law: OwnLaw::new(law, name, discontinuities, switch)? })
    }

    fn __repr__(&self) -> String {
        format!("MarkerForce({:?}, {})", self.between, self.law.name())
    }
}

impl MarkerForce {
    /// The law between the markers of a system.
    pub(crate) fn of(&self, py: Python<'_>, scene: &scene::Scene, faults: &Faults) -> PyResult<MarkerForces> {
        let ends = scene.ends();
        let names: Vec<String> = ends.iter().map(|end| scene.name_of(*end)).collect();
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
        let law = self.law.in_run(py, faults);
        Ok(MarkerForces { name: law.name.clone(), between, law: Arc::new(law) })
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

/// The force and the moment that a law of this name has returned.
fn returned(value: &Bound<'_, PyAny>, name: &str) -> PyResult<[Vector3<f64>; 2]> {
    let [force, moment] = ["force", "moment"].map(|of| format!("the {of} of the law `{name}`"));
    match value.len() {
        Ok(3) => Ok([vector(value, &force)?, Vector3::zeros()]),
        Ok(2) => Ok([vector(&value.get_item(0)?, &force)?, vector(&value.get_item(1)?, &moment)?]),
        _ => {
            let (what, expected) = (format!("the law `{name}`"), "a force, or a force and a moment");
            let help = "return three numbers, or two times three";
            Err(wrong_input(value.py(), &what, &described(value), expected, help))
        }
    }
}

impl MarkerLaw for LawInRun {
    fn force_and_moment(&self, [time, _]: [f64; 2], motion: &dynamics::RelativeMotion) -> [Vector3<f64>; 2] {
        let asked = self.ask(time, (time, RelativeMotion(*motion)), |value| returned(value, &self.name));
        asked.unwrap_or([Vector3::repeat(f64::NAN); 2])
    }

    fn switch(&self, [time, _]: [f64; 2], motion: &dynamics::RelativeMotion) -> Option<f64> {
        self.switch_at(time, (time, RelativeMotion(*motion)))
    }

    fn discontinuities(&self) -> Vec<f64> {
        self.discontinuities.clone()
    }
}
