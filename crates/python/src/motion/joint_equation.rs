//! The class JointEquation: one more equation of a joint, a function of Python.

use std::fmt;
use std::sync::Arc;

use flexframe::dynamics::{self, EquationValue, RelativePlace};
use flexframe::motion::OwnEquation;
use flexframe::nalgebra::Vector3;
use flexframe::scene;
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::errors::wrong_input;
use crate::motion::faults::Faults;
use crate::motion::joint_force::joint_number;
use crate::motion::law::Law;
use crate::values::arrays::matrix;
use crate::values::numbers::{described, number, vector};

/// One more equation of a joint: a point on a wire, a cam, a rod of one length. The joint keeps it at zero, beside what it holds
/// otherwise (`locked = []` holds nothing).
///
/// `equation` is a function of the place of the second end as the first sees it, in the axes of the first: the position (3), and
/// the matrix that takes components along the axes of the second end to those along the axes of the first (3x3). It returns the
/// residual, a length or an angle; its derivative by the position (3); and, if it depends on the axes, its derivative by a small turn
/// of the second end (3). The three are compared at the beginning. It must depend on nothing but the place.
#[pyclass(frozen, module = "flexframe")]
pub(crate) struct JointEquation {
    joint: String,
    law: Law,
}

#[pymethods]
impl JointEquation {
    #[new]
    #[pyo3(signature = (joint, equation, *, name=None))]
    fn new(joint: String, equation: &Bound<'_, PyAny>, name: Option<String>) -> PyResult<Self> {
        Ok(Self { joint, law: Law::new(equation, name, Vec::new(), None)? })
    }

    fn __repr__(&self) -> String {
        format!("JointEquation({:?}, {})", self.joint, self.law.name)
    }
}

impl JointEquation {
    /// The equation at a joint of a system.
    pub(crate) fn of(&self, py: Python<'_>, scene: &scene::Scene, faults: &Faults) -> PyResult<OwnEquation> {
        let joint = joint_number(py, &self.joint, scene)?;
        let equation = PythonEquation {
            function: self.law.function.clone_ref(py),
            name: self.law.name.clone(),
            faults: faults.clone(),
        };
        Ok(OwnEquation { joint, equation: Arc::new(equation) })
    }
}

struct PythonEquation {
    function: Py<PyAny>,
    name: String,
    faults: Faults,
}

impl PythonEquation {
    fn asked(&self, py: Python<'_>, place: &RelativePlace) -> PyResult<EquationValue> {
        let position = PyArray1::from_slice(py, place.position.as_slice());
        let value = self.function.bind(py).call1((position, matrix(py, &place.axes)))?;
        let of = |what: &str| format!("the {what} of the equation `{}`", self.name);
        let (count @ (2 | 3), Some(residual)) =
            (value.len().unwrap_or(0), value.get_item(0).ok().and_then(|first| number(&first)))
        else {
            let expected = "a residual and its derivative by the position, or also that by a turn";
            let help = "return a number and three numbers, or a number and twice three";
            return Err(wrong_input(py, &format!("the equation `{}`", self.name), &described(&value), expected, help));
        };
        let by_turn = match count {
            3 => vector(&value.get_item(2)?, &of("derivative by a turn"))?,
            _ => Vector3::zeros(),
        };
        Ok(EquationValue {
            residual,
            by_position: vector(&value.get_item(1)?, &of("derivative by the position"))?,
            by_turn,
        })
    }
}

impl fmt::Debug for PythonEquation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}`", self.name)
    }
}

impl dynamics::JointEquation for PythonEquation {
    fn value(&self, place: &RelativePlace) -> EquationValue {
        let asked = self.faults.ask(|| format!("in the equation `{}`", self.name), |py| self.asked(py, place));
        asked.unwrap_or(EquationValue {
            residual: f64::NAN,
            by_position: Vector3::repeat(f64::NAN),
            by_turn: Vector3::repeat(f64::NAN),
        })
    }
}
