//! Exceptions of Python functions while a step is taken, kept until the step has come back.

use std::sync::{Arc, Mutex, PoisonError};

use pyo3::prelude::*;

/// The first exception that a law or an event of a run has raised. A step in which there is one fails, since its loads are
/// not numbers, and the motion stays where it was before it.
#[derive(Clone, Default)]
pub(crate) struct Faults(Arc<Mutex<Option<PyErr>>>);

impl Faults {
    /// Keeps an exception, if it is the first.
    pub(crate) fn put(&self, error: PyErr) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
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
