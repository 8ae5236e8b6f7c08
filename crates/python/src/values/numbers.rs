//! Numbers from Python.

use flexframe::nalgebra::Vector3;
use numpy::{PyReadonlyArray1, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyComplex;

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
        Err(_) => {
            let items = value.extract::<Vec<Bound<'_, PyAny>>>().ok();
            let list: Option<Vec<f64>> = items.and_then(|items| items.iter().map(number).collect());
            list.ok_or_else(|| refuse(&described(value)))?
        }
    };
    if list.len() != count {
        return Err(refuse(&format!("{} numbers", list.len())));
    }
    match list.iter().position(|number| !number.is_finite()) {
        Some(i) => Err(refuse(&format!("{} as number {}", list[i], i + 1))),
        None => Ok(list),
    }
}

/// A real number from Python. What has an imaginary part is none, although NumPy would leave that part out.
pub(crate) fn number(value: &Bound<'_, PyAny>) -> Option<f64> {
    let kind = value.getattr("dtype").and_then(|kind| kind.getattr("kind")?.extract::<String>());
    let is_complex = value.is_instance_of::<PyComplex>() || kind.is_ok_and(|kind| kind == "c");
    value.extract().ok().filter(|_| !is_complex)
}

/// A real number from Python that is what it is to be; or else an exception that says what was found.
pub(crate) fn number_that(
    value: &Bound<'_, PyAny>,
    is_one: impl Fn(f64) -> bool,
    [what, expected, help]: [&str; 3],
) -> PyResult<f64> {
    let found = match number(value) {
        Some(number) if is_one(number) => return Ok(number),
        Some(number) => number.to_string(),
        None => described(value),
    };
    Err(wrong_input(value.py(), what, &found, expected, help))
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
