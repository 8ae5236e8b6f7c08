//! The columns of a results file, and the shapes of their arrays.

use flexframe::columns::COLUMNS;
use flexframe::results::{Column, Metadata, Values, present};
use flexframe::row::Row;
use numpy::{IntoPyArray, PyArrayDyn, PyArrayMethods};
use pyo3::prelude::*;

/// The columns that a run with this metadata has.
pub(crate) fn of_run(metadata: &Metadata) -> impl Iterator<Item = &'static Column<Row>> {
    present(&COLUMNS, metadata)
}

/// Names of the dimensions of a row's values.
pub(crate) fn dimensions(column: &Column<Row>) -> Vec<String> {
    let names: &[&str] = match column.values {
        Values::Number(_) => &[],
        Values::Vector(_) => &["axis"],
        Values::Quaternion(_) => &["quaternion"],
        Values::Modal(_) => &["mode"],
        Values::Points(_) => &["point", "axis"],
        Values::Supports(_) => &["support", "axis"],
        Values::PointNumbers(1, _) => &["point"],
        Values::PointNumbers(..) => {
            let quantity = column.path.rsplit('/').next().unwrap_or_default();
            return vec!["point".to_owned(), format!("{quantity}_component")];
        }
    };
    names.iter().map(|name| (*name).to_owned()).collect()
}

/// The values of a row in a column, in the shape that they have there.
pub(crate) fn of_row<'py>(
    py: Python<'py>,
    column: &Column<Row>,
    metadata: &Metadata,
    row: &Row,
) -> PyResult<Bound<'py, PyAny>> {
    let mut values = Vec::new();
    column.append(row, metadata, &mut values);
    match (column.row_shape(metadata).as_slice(), values.as_slice()) {
        ([], [value]) => Ok(value.into_pyobject(py)?.into_any()),
        (shape, _) => shaped(py, values, shape),
    }
}

/// An array that takes over the numbers.
pub(crate) fn shaped<'py>(py: Python<'py>, values: Vec<f64>, shape: &[usize]) -> PyResult<Bound<'py, PyAny>> {
    let array: Bound<'py, PyArrayDyn<f64>> = values.into_pyarray(py).reshape(shape)?;
    Ok(array.into_any())
}
