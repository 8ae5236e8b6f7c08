//! Errors as exceptions: of the class of their kind, with the message of the program.

use std::ffi::CString;

use diagnostic::{Diagnosis, Diagnostic, Kind, Refusal};
use pyo3::exceptions::{PyKeyboardInterrupt, PyUserWarning};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The module of the exceptions, written in Python: they have two parents each.
const MODULE: &str = "flexframe.errors";

/// The exception of an error.
pub(crate) fn exception(py: Python<'_>, error: &dyn Diagnostic) -> PyErr {
    exception_of(py, &error.to_string(), &error.diagnosis())
}

/// The exception of a kind, with a message.
pub(crate) fn exception_of(py: Python<'_>, message: &str, diagnosis: &Diagnosis) -> PyErr {
    let class = match diagnosis.kind {
        Kind::Usage | Kind::Input => "InputError",
        Kind::Refused => "RefusedError",
        Kind::Run => "RunError",
        Kind::Io => "FileError",
        Kind::Stopped => return PyKeyboardInterrupt::new_err(message.to_owned()),
    };
    made(py, class, message, diagnosis).unwrap_or_else(|error| error)
}

/// Error for an argument of a function that is not of its kind: its name, the value found, the one expected, and help.
pub(crate) fn wrong_input(py: Python<'_>, what: &str, found: &str, expected: &str, help: &str) -> PyErr {
    exception(py, &Refusal::from(Kind::Input.alone().key(what).found(found).expected(expected).help(help)))
}

fn made(py: Python<'_>, class: &str, message: &str, diagnosis: &Diagnosis) -> PyResult<PyErr> {
    let Diagnosis { file, line, key, found, expected, help, .. } = diagnosis;
    let known = PyDict::new(py);
    known.set_item("file", file)?;
    known.set_item("line", line)?;
    known.set_item("key", key)?;
    known.set_item("found", found)?;
    known.set_item("expected", expected)?;
    known.set_item("help", help)?;
    let error = py.import(MODULE)?.getattr(class)?.call((message,), Some(&known))?;
    Ok(PyErr::from_value(error))
}

/// Tells sentences as warnings of Python, which may be switched off or made errors.
pub(crate) fn warn(py: Python<'_>, sentences: impl IntoIterator<Item = String>) -> PyResult<()> {
    let category = py.get_type::<PyUserWarning>();
    for sentence in sentences {
        // A text of a user may have a zero, which C ends at.
        let text = CString::new(sentence.replace('\0', "")).unwrap_or_default();
        PyErr::warn(py, &category, &text, 1)?;
    }
    Ok(())
}

/// Adds a sentence that is shown below the exception, where Python knows notes (from 3.11 on).
pub(crate) fn add_note(py: Python<'_>, error: &PyErr, note: &str) {
    // An exception without the note tells nearly as much.
    let _ = error.value(py).call_method1("add_note", (note,));
}
