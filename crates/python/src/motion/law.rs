//! Laws whose functions are of Python, and what steps must know of them.

use std::fmt;

use pyo3::call::PyCallArgs;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use crate::errors::wrong_input;
use crate::motion::faults::Faults;
use crate::values::numbers::number_that;

/// A law: a function of the motion, and what steps must know of it.
pub(crate) struct Law {
    pub function: Py<PyAny>,
    pub name: String,
    pub discontinuities: Vec<f64>,
    pub longest_step: Option<f64>,
}

impl Law {
    pub fn new(
        function: &Bound<'_, PyAny>,
        name: Option<String>,
        discontinuities: Vec<f64>,
        longest_step: Option<f64>,
    ) -> PyResult<Self> {
        let py = function.py();
        if !function.is_callable() {
            let found = function.get_type().name()?;
            return Err(PyTypeError::new_err(format!("a law is a function of the motion; found {found}")));
        }
        if let Some(discontinuity) = discontinuities.iter().find(|discontinuity| !discontinuity.is_finite()) {
            let help = "name the times at which the law or its rate jumps";
            return Err(wrong_input(py, "discontinuities", &discontinuity.to_string(), "finite times", help));
        }
        if let Some(step) = longest_step.filter(|step| !(*step > 0.0 && step.is_finite())) {
            let help = "name the longest step that sees the law as it is";
            return Err(wrong_input(py, "longest_step", &step.to_string(), "a positive number", help));
        }
        let name = match name {
            Some(name) => name,
            None => function.getattr("__name__").and_then(|name| name.extract()).unwrap_or_else(|_| "law".to_owned()),
        };
        Ok(Self { function: function.clone().unbind(), name, discontinuities, longest_step })
    }
}

/// The law of a force in a system, and the function that changes its sign where it has a kink.
pub(crate) struct OwnLaw {
    law: Law,
    switch: Option<Py<PyAny>>,
}

impl OwnLaw {
    pub fn new(
        function: &Bound<'_, PyAny>,
        name: Option<String>,
        discontinuities: Vec<f64>,
        switch: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        if let Some(switch) = switch.as_ref().filter(|switch| !switch.is_callable()) {
            let found = switch.get_type().name()?;
            return Err(PyTypeError::new_err(format!(
                "a switch is a function of what the law is a function of; found {found}\n = let it return a number that changes its \
                 sign where the law has a kink, such as the gap of a contact"
            )));
        }
        Ok(Self { law: Law::new(function, name, discontinuities, None)?, switch: switch.map(Bound::unbind) })
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.law.name
    }

    /// The same for a run, which keeps what it raises.
    pub fn in_run(&self, py: Python<'_>, faults: &Faults) -> LawInRun {
        let Law { function, name, discontinuities, .. } = &self.law;
        LawInRun {
            function: function.clone_ref(py),
            switch: self.switch.as_ref().map(|switch| switch.clone_ref(py)),
            name: name.clone(),
            discontinuities: discontinuities.clone(),
            faults: faults.clone(),
        }
    }
}

/// A law in a run.
pub(crate) struct LawInRun {
    function: Py<PyAny>,
    switch: Option<Py<PyAny>>,
    pub name: String,
    pub discontinuities: Vec<f64>,
    faults: Faults,
}

impl fmt::Debug for LawInRun {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "law {} of Python", self.name)
    }
}

impl LawInRun {
    /// Calls the law at a time, and reads what it returns; `None` where one has raised.
    pub fn ask<T>(
        &self,
        time: f64,
        arguments: impl for<'py> PyCallArgs<'py>,
        read: impl FnOnce(&Bound<'_, PyAny>) -> PyResult<T>,
    ) -> Option<T> {
        let note = || format!("in the law `{}` at time {time}", self.name);
        self.faults.ask(note, |py| read(&self.function.bind(py).call1(arguments)?))
    }

    /// The function that changes its sign at kinks; `None` where the law has none, or one has raised.
    pub fn switch_at(&self, time: f64, arguments: impl for<'py> PyCallArgs<'py>) -> Option<f64> {
        let switch = self.switch.as_ref()?;
        let note = || format!("in the switch of the law `{}` at time {time}", self.name);
        let asked = self.faults.ask(note, |py| {
            let what = format!("the switch of the law `{}`", self.name);
            let help = "return a number that changes its sign where the law has a kink";
            number_that(&switch.bind(py).call1(arguments)?, |value| !value.is_nan(), [&what, "a number", help])
        });
        Some(asked.unwrap_or(f64::NAN))
    }
}
