//! The constants of a reduced body, as arrays.

use std::sync::Arc;

use flexframe::faer::Mat;
use flexframe::model::Model;
use flexframe::nalgebra::{Matrix3, Vector3};
use flexframe::reduced_body::Constants;
use numpy::ndarray::ArrayView1;
use numpy::{IntoPyArray, PyArrayDyn, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::values::arrays::{matrix3, view};

/// All of them by the names of [`Constants`]: those without an index of their own look into the model, the others are put
/// together.
pub(crate) fn constants<'py>(py: Python<'py>, model: &Arc<Model>) -> PyResult<Bound<'py, PyDict>> {
    let vector =
        |of: fn(&Constants) -> &Vector3<f64>| view(py, model, move |m| ArrayView1::from(of(&m.body).as_slice()));
    let basis = |of: fn(&Constants) -> &Matrix3<f64>| view(py, model, move |m| matrix3(of(&m.body)));
    let body = &model.body;

    let out = PyDict::new(py);
    out.set_item("mass", body.mass)?;
    out.set_item("center_of_mass", vector(|body| &body.center_of_mass)?)?;
    out.set_item("origin", vector(|body| &body.origin)?)?;
    out.set_item("inertia", basis(|body| &body.inertia)?)?;
    out.set_item("translation_basis", basis(|body| &body.translation_basis)?)?;
    out.set_item("rotation_basis", basis(|body| &body.rotation_basis)?)?;
    let frequencies = view(py, model, |m| ArrayView1::from(m.body.circular_frequencies.as_slice()))?;
    out.set_item("circular_frequencies", frequencies)?;
    out.set_item("rotation_products", matrices(py, &[3, 3], body.rotation_products.as_flattened())?)?;
    out.set_item("position_products", lists(py, &[3, 3], body.position_products.as_flattened())?)?;
    out.set_item("inertia_first", lists(py, &[6], &body.inertia_first)?)?;
    out.set_item("inertia_second", matrices(py, &[6], &body.inertia_second)?)?;
    out.set_item("gyroscopic", matrices(py, &[3], &body.gyroscopic)?)?;
    out.set_item("translation_first", lists(py, &[3], &body.translation_first)?)?;
    out.set_item("rotation_first", lists(py, &[3], &body.rotation_first)?)?;
    if let Some(stiffness) = &body.stress_stiffness {
        out.set_item("stress_stiffness", matrices(py, &[6], stiffness)?)?;
    }
    Ok(out)
}

/// Lists of one length as an array that is only read.
fn lists<'py>(py: Python<'py>, indices: &[usize], lists: &[Vec<f64>]) -> PyResult<Bound<'py, PyAny>> {
    let length = lists.first().map_or(0, Vec::len);
    read_only(py, lists.concat(), &[indices, &[length]].concat())
}

/// Matrices of one size as an array that is only read.
fn matrices<'py>(py: Python<'py>, indices: &[usize], matrices: &[Mat<f64>]) -> PyResult<Bound<'py, PyAny>> {
    let size = matrices.first().map_or([0, 0], |matrix| [matrix.nrows(), matrix.ncols()]);
    let rows = matrices.iter().flat_map(|matrix| matrix.row_iter());
    let entries = rows.flat_map(|row| row.iter().copied().collect::<Vec<_>>()).collect();
    read_only(py, entries, &[indices, &size].concat())
}

fn read_only<'py>(py: Python<'py>, entries: Vec<f64>, shape: &[usize]) -> PyResult<Bound<'py, PyAny>> {
    let array: Bound<'py, PyArrayDyn<f64>> = entries.into_pyarray(py).reshape(shape)?;
    array.readwrite().make_nonwriteable();
    Ok(array.into_any())
}
