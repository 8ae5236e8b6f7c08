//! numpy arrays that look into the model of a body: no copy. They are read-only, and keep the model alive.

use std::sync::Arc;

use flexframe::faer::MatRef;
use flexframe::model::Model;
use flexframe::nalgebra::Matrix3;
use numpy::ndarray::{ArrayView, ArrayView2, ArrayView3, Dimension, ShapeBuilder};
use numpy::{Element, PyArray, PyArray2, PyArrayMethods};
use pyo3::prelude::*;

/// The base of an array that looks into a model: a share of the model.
#[pyclass(frozen, module = "flexframe._flexframe")]
struct Memory(Arc<Model>);

/// An array of numbers that a model owns.
pub(crate) fn view<'py, T: Element, D: Dimension>(
    py: Python<'py>,
    model: &Arc<Model>,
    select: impl for<'m> FnOnce(&'m Model) -> ArrayView<'m, T, D>,
) -> PyResult<Bound<'py, PyArray<T, D>>> {
    let memory = Bound::new(py, Memory(model.clone()))?;
    let array = select(&memory.get().0);
    // SAFETY: `select` knows nothing of the model but that it lives for 'm, so that what it selects is inside of the model
    // (or static). A model is neither moved nor changed while anybody has a share in it, the array keeps the memory that has
    // one, and nothing can be written through the array.
    #[allow(unsafe_code)]
    let array = unsafe { PyArray::borrow_from_array(&array, memory.clone().into_any()) };
    array.readwrite().make_nonwriteable();
    Ok(array)
}

/// A matrix whose columns are fields over `nodes`: columns × nodes × numbers at each node.
pub(crate) fn fields(matrix: MatRef<'_, f64>, nodes: usize) -> ArrayView3<'_, f64> {
    let each = matrix.nrows().checked_div(nodes).unwrap_or(0);
    let (row, column) = (matrix.row_stride().unsigned_abs(), matrix.col_stride().unsigned_abs());
    let shape = (matrix.ncols(), nodes, each);
    // SAFETY: that is where faer says that the entries are; those of a matrix that owns them have positive strides. Entry
    // (k, i, axis) is in row each·i + axis, of which there are no more than the matrix has, and in column k.
    #[allow(unsafe_code)]
    unsafe {
        ArrayView3::from_shape_ptr(shape.strides((column, each * row, row)), matrix.as_ptr())
    }
}

/// A matrix of three rows and columns.
pub(crate) fn matrix3(matrix: &Matrix3<f64>) -> ArrayView2<'_, f64> {
    columns3(matrix.as_slice()).unwrap_or_else(|| ArrayView2::from(&[[0.0; 3]; 0]))
}

fn columns3(slice: &[f64]) -> Option<ArrayView2<'_, f64>> {
    ArrayView2::from_shape((3, 3).f(), slice).ok()
}

/// A list of lists of N numbers as a table.
pub(crate) fn table<T, const N: usize>(list: &[[T; N]]) -> ArrayView2<'_, T> {
    ArrayView2::from(list)
}

/// A small matrix as an array of its own (3x3): a copy.
pub(crate) fn matrix<'py>(py: Python<'py>, matrix: &Matrix3<f64>) -> Bound<'py, PyArray2<f64>> {
    // nalgebra has columns where numpy has rows.
    let rows: [[f64; 3]; 3] = matrix.transpose().into();
    PyArray2::from_array(py, &table(&rows))
}
