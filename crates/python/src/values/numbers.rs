//! Numbers from Python.

use flexframe::nalgebra::Vector3;
use numpy::{PyReadonlyArray1, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::errors::wrong_input;

/// A number of finite numbers from a list, a tuple or an array of them. `what` they are is said where they are not.
pub(crate) fn numbers(value: &Bound<'_, PyAny>, count: usize, what: &str) -> PyResult<Vec<f64>> {
    let py = value.py();
    let refuse = |found: &str| {
        let expected = format!("{count} finite number{}", if count == 1 { "" } else { "s" });
        wrong_input(py, what, found, &expected, "give a list or an array of this length")
    };
    let list = match value.extract::<PyReadonlyArray1<'_, f64>>() {
        Ok(array) => array.as_array().to_vec(),
        Err(_) => value.extract::<Vec<f64>>().map_err(|_| refuse(&described(value)))?,
    };
    if list.len() != count {
        return Err(refuse(&format!("{} numbers", list.len())));
    }
    match list.iter().position(|number| !number.is_finite()) {
        Some(i) => Err(refuse(&format!("{} as number {}", list[i], i + 1))),
        None => Ok(list),
    }
}

/// Three of them.
pub(crate) fn vector(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Vector3<f64>> {
    Ok(Vector3::from_vec(numbers(value, 3, what)?))
}

/// A value in a few words.
pub(crate) fn described(value: &Bound<'_, PyAny>) -> String {
    if value.is_none() {
        return "None".to_owned();
    }
    let kind = value.get_type().name().map_or_else(|_| "value".to_owned(), |name| name.to_string());
    match value.cast::<numpy::PyUntypedArray>() {
        Ok(array) => format!("an array of shape {:?} and type {}", array.shape(), array.dtype()),
        Err(_) => format!("a {kind}"),
    }
}
