//! The class Row: what is known of the motion at one time, by the names of the columns of a results file.

use std::sync::Arc;

use flexframe::dynamics::Observation;
use flexframe::model::Model;
use flexframe::results::Metadata;
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;

use crate::columns::{of_row, of_run};
use crate::threads::in_pool;

/// The motion at one time: a number or an array for each column of a results file, by its path.
#[pyclass(frozen, mapping, module = "flexframe")]
pub(crate) struct Row {
    row: flexframe::row::Row,
    metadata: Arc<Metadata>,
}

impl Row {
    pub(crate) fn new(motion: &Observation, model: &Model, metadata: &Arc<Metadata>) -> PyResult<Self> {
        let mut row = flexframe::row::Row::new(model);
        row.motion.clone_from(motion);
        in_pool(|| row.complete(model))?;
        Ok(Self { row, metadata: metadata.clone() })
    }
}

#[pymethods]
impl Row {
    /// Time.
    #[getter]
    fn time(&self) -> f64 {
        self.row.time
    }

    /// Paths of its columns.
    fn keys(&self) -> Vec<&'static str> {
        of_run(&self.metadata).map(|column| column.path).collect()
    }

    fn __len__(&self) -> usize {
        of_run(&self.metadata).count()
    }

    fn __contains__(&self, path: &str) -> bool {
        of_run(&self.metadata).any(|column| column.path == path)
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.keys().into_pyobject(py)?.call_method0("__iter__")
    }

    fn __getitem__<'py>(&self, py: Python<'py>, path: &str) -> PyResult<Bound<'py, PyAny>> {
        if let Some(column) = of_run(&self.metadata).find(|column| column.path == path) {
            return of_row(py, column, &self.metadata, &self.row);
        }
        // points/NAME/velocity
        let of_place = path.split_once('/').and_then(|(group, rest)| rest.rsplit_once('/').map(|parts| (group, parts)));
        if let Some((group, (name, quantity))) = of_place {
            let column = of_run(&self.metadata).find(|column| column.path == format!("{group}/{quantity}"));
            let place = column.and_then(|column| {
                let names = column.places(&self.metadata);
                names.iter().position(|known| known == name).map(|number| (column, number))
            });
            if let Some((column, number)) = place {
                return of_row(py, column, &self.metadata, &self.row)?.get_item(number);
            }
        }
        Err(PyKeyError::new_err(format!("{path:?} is no column of this run; it has {}", self.keys().join(", "))))
    }

    fn __repr__(&self) -> String {
        format!("Row(time {} {})", self.row.time, self.metadata.units.time)
    }
}
