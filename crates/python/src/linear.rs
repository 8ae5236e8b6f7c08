//! Matrices of linear models, for `linear.py`.

use flexframe::linear::{Channel, StateSpace};
use flexframe::linearize::{LinearSettings, Reduction, linear_space};
use flexframe::model::BuildProgress;
use numpy::{PyArray2, PyArrayMethods, ToPyArray};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::body::built;
use crate::errors::wrong_input;
use crate::scene::Scene;

/// The state space of small motions of a scene: A, B, C, D, and names and units.
#[pyfunction]
#[pyo3(signature = (scene, *, spin, time, without_rigid, inputs, outputs, reduce))]
#[allow(clippy::too_many_arguments)] // keywords of the function in Python
pub(crate) fn linearized<'py>(
    py: Python<'py>,
    scene: Py<Scene>,
    spin: Option<[f64; 3]>,
    time: Option<f64>,
    without_rigid: bool,
    inputs: Vec<String>,
    outputs: Vec<String>,
    reduce: Option<String>,
) -> PyResult<Bound<'py, PyDict>> {
    let reduction = reduce.map(|text| text.parse::<Reduction>().map_err(|expected| (text, expected)));
    let reduction = reduction.transpose().map_err(|(found, expected)| {
        let expected = expected.trim_start_matches("expected ");
        wrong_input(py, "reduce", &found, expected, "give the way and the number of states")
    })?;
    let settings = LinearSettings { spin, time, without_rigid, inputs, outputs };
    let (whole, builder) = (scene.get().whole().clone(), scene.get().builder().clone());
    let work = move |told: &mut dyn FnMut(BuildProgress)| linear_space(&whole, &builder, &settings, reduction, told);
    let space = built(py, &scene, work)?;
    let StateSpace { a, b, c, d, states, inputs, outputs } = space.model();
    let found = PyDict::new(py);
    for (name, matrix) in [("A", a), ("B", b), ("C", c), ("D", d)] {
        let rows: Vec<f64> =
            (0..matrix.nrows()).flat_map(|i| (0..matrix.ncols()).map(move |j| matrix[(i, j)])).collect();
        let array: Bound<'_, PyArray2<f64>> = rows.to_pyarray(py).reshape([matrix.nrows(), matrix.ncols()])?;
        found.set_item(name, array)?;
    }
    for (name, list) in [("states", states), ("inputs", inputs), ("outputs", outputs)] {
        let pairs: Vec<(&str, &str)> = list.iter().map(|Channel { name, unit }| (&name[..], &unit[..])).collect();
        found.set_item(name, pairs)?;
    }
    found.set_item("error_bound", space.balanced().map(|(bound, _)| *bound))?;
    let state = &space.state;
    found.set_item("time", state.time)?;
    found.set_item("omega_global", state.omega_global)?;
    found.set_item("warnings", &state.warnings)?;
    Ok(found)
}
