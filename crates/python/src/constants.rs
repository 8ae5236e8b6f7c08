//! The constants of a reduced body, as arrays without a copy.

use std::ops::Range;
use std::sync::Arc;

use flexframe::faer::{Mat, MatRef};
use flexframe::modal::Constants;
use flexframe::nalgebra::{Matrix3, Vector3};
use flexframe::scene::Model;
use numpy::ndarray::ArrayView1;
use pyo3::PyTypeInfo;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::arrays::{matrix, matrix3, view};

/// A list or a matrix among the constants.
type Of<T> = fn(&Constants, usize) -> &T;

/// All of them by the names of [`Constants`].
pub(crate) fn constants<'py>(py: Python<'py>, model: &Arc<Model>) -> PyResult<Bound<'py, PyDict>> {
    let list = |of: Of<Vec<f64>>, i: usize| view(py, model, move |m| ArrayView1::from(of(&m.body, i).as_slice()));
    let square = |of: Of<Mat<f64>>, i: usize| view(py, model, move |m| matrix(of(&m.body, i).as_ref()));
    let vector =
        |of: fn(&Constants) -> &Vector3<f64>| view(py, model, move |m| ArrayView1::from(of(&m.body).as_slice()));
    let basis = |of: fn(&Constants) -> &Matrix3<f64>| view(py, model, move |m| matrix3(of(&m.body)));
    let lists = |of: Of<Vec<f64>>, which: Range<usize>| tuple(py, which.map(|i| list(of, i)));
    let squares = |of: Of<Mat<f64>>, which: Range<usize>| tuple(py, which.map(|i| square(of, i)));

    let out = PyDict::new(py);
    out.set_item("mass", model.body.mass)?;
    out.set_item("center_of_mass", vector(|body| &body.center_of_mass)?)?;
    out.set_item("origin", vector(|body| &body.origin)?)?;
    out.set_item("inertia", basis(|body| &body.inertia)?)?;
    out.set_item("translation_basis", basis(|body| &body.translation_basis)?)?;
    out.set_item("rotation_basis", basis(|body| &body.rotation_basis)?)?;
    out.set_item("circular_frequencies", list(|body, _| &body.circular_frequencies, 0)?)?;
    let products = |row: usize| squares(|body, i| &body.rotation_products[i / 3][i % 3], 3 * row..3 * row + 3);
    out.set_item("rotation_products", tuple(py, (0..3).map(products))?)?;
    let products = |row: usize| lists(|body, i| &body.position_products[i / 3][i % 3], 3 * row..3 * row + 3);
    out.set_item("position_products", tuple(py, (0..3).map(products))?)?;
    out.set_item("inertia_first", lists(|body, i| &body.inertia_first[i], 0..6)?)?;
    out.set_item("inertia_second", squares(|body, i| &body.inertia_second[i], 0..6)?)?;
    out.set_item("gyroscopic", squares(|body, i| &body.gyroscopic[i], 0..3)?)?;
    out.set_item("translation_first", lists(|body, i| &body.translation_first[i], 0..3)?)?;
    out.set_item("rotation_first", lists(|body, i| &body.rotation_first[i], 0..3)?)?;
    if model.body.stress_stiffness.is_some() {
        let stiffness = |i: usize| {
            view(py, model, move |m| {
                let none = || MatRef::from_column_major_slice(&[], 0, 0);
                matrix(m.body.stress_stiffness.as_ref().map_or_else(none, |k| k[i].as_ref()))
            })
        };
        out.set_item("stress_stiffness", tuple(py, (0..6).map(stiffness))?)?;
    }
    Ok(out)
}

fn tuple<'py, T: PyTypeInfo>(
    py: Python<'py>,
    parts: impl Iterator<Item = PyResult<Bound<'py, T>>>,
) -> PyResult<Bound<'py, PyTuple>> {
    PyTuple::new(py, parts.collect::<PyResult<Vec<_>>>()?)
}
