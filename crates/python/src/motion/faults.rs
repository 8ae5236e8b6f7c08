//! Exceptions of Python functions while a step is taken, kept until the step has come back.

use std::sync::{Arc, Mutex, PoisonError};

use pyo3::prelude::*;

use crate::errors::add_note;

/// The first exception that a law or an event of a run has raised. A step in which there is one fails, since its loads are
/// not numbers, and the motion stays where it was before it.
#[derive(Clone, Default)]
pub(crate) struct Faults(Arc<Mutex<Option<PyErr>>>);

impl Faults {
    /// Keeps an exception, if it is the first.
    pub(crate) fn put(&self, error: PyErr) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
    }

    /// The answer of a function of Python; `None` where it or one before it has raised. Its exception is kept, with a note.
    pub(crate) fn ask<T>(
        &self,
        note: impl FnOnce() -> String,
        ask: impl FnOnce(Python<'_>) -> PyResult<T>,
    ) -> Option<T> {
        if self.any() {
            return None;
        }
        let asked = Python::attach(|py| ask(py).inspect_err(|error| add_note(py, error, &note())));
        asked.map_err(|error| self.put(error)).ok()
    }

    /// True if there is one: then no function needs to be asked any more.
    pub(crate) fn any(&self) -> bool {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).is_some()
    }

    /// Takes it out.
    pub(crate) fn take(&self) -> Option<PyErr> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}
