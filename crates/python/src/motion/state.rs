//! A state as a dict.

use flexframe::dynamics::MotionState;
use flexframe::rigid_kin::Attitude;
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::wrong_input;
use crate::values::numbers::{numbers, vector};

const KEYS: [&str; 7] =
    ["time", "attitude", "origin", "velocity", "angular_velocity", "modal_displacement", "modal_velocity"];

/// A state as a dict of arrays of its own.
pub(crate) fn to_dict<'py>(py: Python<'py>, state: &MotionState) -> PyResult<Bound<'py, PyDict>> {
    let array = |values: &[f64]| PyArray1::from_slice(py, values);
    let out = PyDict::new(py);
    out.set_item("time", state.time)?;
    out.set_item("attitude", state.attitude.wxyz().to_vec().into_pyarray(py))?;
    out.set_item("origin", array(state.origin_global.as_slice()))?;
    out.set_item("velocity", array(state.velocity_global.as_slice()))?;
    out.set_item("angular_velocity", array(state.omega_body.as_slice()))?;
    out.set_item("modal_displacement", array(&state.modal_displacement))?;
    out.set_item("modal_velocity", array(&state.modal_velocity))?;
    Ok(out)
}

/// The state `now` with the values of a dict in place of its own.
pub(crate) fn changed(now: MotionState, values: &Bound<'_, PyDict>) -> PyResult<MotionState> {
    let py = values.py();
    let flexible = now.modal_displacement.len();
    let mut state = now;
    for (key, value) in values {
        let key: String = key.extract()?;
        let what = format!("state[{key:?}]");
        match key.as_str() {
            "time" => state.time = one(&value, &what)?,
            "attitude" => state.attitude = attitude(&value, &state.attitude, &what)?,
            "origin" => state.origin_global = vector(&value, &what)?,
            "velocity" => state.velocity_global = vector(&value, &what)?,
            "angular_velocity" => state.omega_body = vector(&value, &what)?,
            "modal_displacement" => state.modal_displacement = numbers(&value, flexible, &what)?,
            "modal_velocity" => state.modal_velocity = numbers(&value, flexible, &what)?,
            _ => {
                let expected = format!("one of {}", KEYS.join(", "));
                let help = "change the dict that state() gives, or give some of its keys";
                return Err(wrong_input(py, "state", &format!("the key {key:?}"), &expected, help));
            }
        }
    }
    Ok(state)
}

fn one(value: &Bound<'_, PyAny>, what: &str) -> PyResult<f64> {
    let list = pyo3::types::PyList::new(value.py(), [value])?;
    Ok(numbers(list.as_any(), 1, what)?.first().copied().unwrap_or_default())
}

/// The attitude of a quaternion, whose length is made one; `now`, to the last bit, where it is that.
fn attitude(value: &Bound<'_, PyAny>, now: &Attitude, what: &str) -> PyResult<Attitude> {
    let wxyz = numbers(value, 4, what)?;
    if wxyz == now.wxyz() {
        return Ok(*now);
    }
    let wxyz = [wxyz[0], wxyz[1], wxyz[2], wxyz[3]];
    Attitude::from_wxyz(wxyz).map_err(|error| {
        let help = "give the quaternion (w, x, y, z) that takes body components to global ones";
        wrong_input(value.py(), what, &error.to_string(), "a quaternion that is not zero", help)
    })
}
