//! Values of Python as values of TOML, each under its path of keys.

use flexframe::scene::key_path;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};
use toml::{Table, Value};

use crate::errors::wrong_input;

/// Lists and dicts within each other, at the most: deeper than any scene, and what contains itself ends.
const DEEPEST: usize = 32;

/// The text of a scene from a dict with its sections, in the order that TOML wants. `name` stands for it in messages.
pub(crate) fn to_text(scene: &Bound<'_, PyDict>, name: &str) -> PyResult<String> {
    let Value::Table(table) = to_toml(scene.as_any(), name, "")? else { return Ok(String::new()) };
    Ok(table.to_string())
}

/// A value, which has the path of keys `key`.
pub(crate) fn to_toml(value: &Bound<'_, PyAny>, name: &str, key: &str) -> PyResult<Value> {
    within(value, name, key, 0)
}

fn within(value: &Bound<'_, PyAny>, name: &str, key: &str, depth: usize) -> PyResult<Value> {
    let py = value.py();
    let refuse = |found: &str, expected: &str, help: &str| {
        let place = if key.is_empty() { name.to_owned() } else { format!("{name}: `{key}`") };
        wrong_input(py, &place, found, expected, help)
    };
    if depth > DEEPEST {
        let expected = format!("at most {DEEPEST}");
        return Err(refuse("more dicts and lists within each other", &expected, "take out what contains itself"));
    }
    let entries = |list: &Bound<'_, PyAny>| -> PyResult<Value> {
        let entry =
            |(i, entry): (usize, PyResult<Bound<'_, PyAny>>)| within(&entry?, name, &format!("{key}[{i}]"), depth + 1);
        Ok(Value::Array(list.try_iter()?.enumerate().map(entry).collect::<PyResult<_>>()?))
    };
    if let Ok(table) = value.cast::<PyDict>() {
        let mut out = Table::new();
        for (inner, value) in table {
            let Ok(inner) = inner.extract::<String>() else {
                let found = format!("the key {}", inner.repr()?);
                return Err(refuse(&found, "keys that are texts", "write it as a text, in quotes"));
            };
            let value = within(&value, name, &key_path(key, &inner), depth + 1)?;
            out.insert(inner, value);
        }
        return Ok(Value::Table(out));
    }
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(Value::String(text.extract()?));
    }
    // True is an int of Python, too.
    if let Ok(is) = value.cast::<PyBool>() {
        return Ok(Value::Boolean(is.is_true()));
    }
    if value.is_instance_of::<PyInt>() {
        let number = value.extract::<i64>();
        let refused = |_| refuse(&value.to_string(), "a whole number of 64 bits", "write it as a float");
        return number.map(Value::Integer).map_err(refused);
    }
    if value.is_instance_of::<PyFloat>() {
        return Ok(Value::Float(value.extract()?));
    }
    if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
        return entries(value);
    }
    // numpy's arrays and numbers.
    if let Ok(list) = value.call_method0("tolist") {
        return within(&list, name, key, depth + 1);
    }
    // Paths.
    if let Ok(path) = value.call_method0("__fspath__") {
        return within(&path, name, key, depth + 1);
    }
    let found =
        if value.is_none() { "None".to_owned() } else { format!("a value of the type {}", value.get_type().name()?) };
    Err(refuse(
        &found,
        "a number, a text, True or False, a path, a list, an array or a dict",
        "leave the key out, or give it such a value",
    ))
}
