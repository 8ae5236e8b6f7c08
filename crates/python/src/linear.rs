//! Matrices of linear models, for `linear.py`.

use flexframe::linear::{Channel, StateSpace};
use flexframe::linearize::{LinearModel, LinearSettings, LinearizeError, Reduced, Reduction, linear_model};
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
    let (system, builder) = (scene.get().system().clone(), scene.get().builder().clone());
    let work = move |told: &mut dyn FnMut(BuildProgress)| -> Result<_, LinearizeError> {
        let LinearModel { equations, state } = linear_model(&system, &builder, &settings, told)?;
        let failed = |source| LinearizeError::Linear { scene: system.bodies[0].path.clone(), source: Box::new(source) };
        let space = equations.state_space().map_err(failed)?;
        let reduced = reduction.map(|reduction| reduction.of(&space)).transpose().map_err(failed)?;
        let (space, bound) = match reduced {
            Some(Reduced { model, balanced }) => (model, balanced.map(|(bound, _)| bound)),
            None => (space, None),
        };
        Ok((space, bound, state))
    };
    let (space, bound, state) = built(py, &scene, work)?;
    let StateSpace { a, b, c, d, states, inputs, outputs } = &space;
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
    found.set_item("error_bound", bound)?;
    found.set_item("time", state.time)?;
    found.set_item("omega_global", state.omega_global)?;
    found.set_item("warnings", state.warnings)?;
    Ok(found)
}
