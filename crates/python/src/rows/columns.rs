//! The columns of a results file, and the shapes of their arrays.

use flexframe::columns::COLUMNS;
use flexframe::results::{self, Components, Metadata, Scope, histories};
use flexframe::row::Row;
use numpy::{IntoPyArray, PyArrayDyn, PyArrayMethods};
use pyo3::prelude::*;

/// A history of a run.
pub(crate) type History = results::History<Row>;

/// The histories of a run with this metadata, but for the time.
pub(crate) fn of_run(metadata: &Metadata) -> impl Iterator<Item = History> {
    histories(&COLUMNS, metadata)
}

/// Name of what a history is of.
pub(crate) fn scope(history: History) -> &'static str {
    match history.column.scope() {
        Scope::System => "system",
        Scope::Body => "body",
        Scope::Point => "point",
        Scope::Support => "support",
        Scope::Joint => "joint",
    }
}

/// Names of the dimensions of a row's values.
pub(crate) fn dimensions(history: History) -> Vec<String> {
    let mut dimensions = Vec::new();
    if history.is_of_places() {
        dimensions.push(scope(history).to_owned());
    }
    match history.column.components() {
        Components::Number => {}
        Components::Vector => dimensions.push("axis".to_owned()),
        Components::Quaternion => dimensions.push("quaternion".to_owned()),
        Components::Modes => dimensions.push("mode".to_owned()),
        Components::Named(_) => dimensions.push(format!("{}_component", history.column.name)),
    }
    dimensions
}

/// The values of a row in a history, in the shape that they have there.
pub(crate) fn of_row<'py>(
    py: Python<'py>,
    history: History,
    metadata: &Metadata,
    row: &Row,
) -> PyResult<Bound<'py, PyAny>> {
    let mut values = Vec::new();
    history.append(row, metadata, &mut values);
    match (history.row_shape(metadata).as_slice(), values.as_slice()) {
        ([], [value]) => Ok(value.into_pyobject(py)?.into_any()),
        (shape, _) => shaped(py, values, shape),
    }
}

/// An array that takes over the numbers.
pub(crate) fn shaped<'py>(py: Python<'py>, values: Vec<f64>, shape: &[usize]) -> PyResult<Bound<'py, PyAny>> {
    let array: Bound<'py, PyArrayDyn<f64>> = values.into_pyarray(py).reshape(shape)?;
    Ok(array.into_any())
}
