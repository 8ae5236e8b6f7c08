//! The class Row: what is known of the motion at one time, by the names of the columns of a results file.

use std::sync::Arc;

use flexframe::model::Model;
use flexframe::results::Metadata;
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;

use crate::rows::columns::{of_row, of_run};
use crate::threads::in_pool;

/// Path of the time.
const TIME: &str = "time";

/// The motion at one time: a number or an array for each column of a results file, by its path.
#[pyclass(frozen, mapping, module = "flexframe")]
pub(crate) struct Row {
    row: flexframe::row::Row,
    metadata: Arc<Metadata>,
}

impl Row {
    /// The row of what has been observed of bodies and joints, with what follows from it.
    pub(crate) fn new(mut row: flexframe::row::Row, models: &[Arc<Model>], metadata: &Arc<Metadata>) -> PyResult<Self> {
        in_pool(|| row.bodies.iter_mut().zip(models).for_each(|(body, model)| body.complete(model)))?;
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
    fn keys(&self) -> Vec<String> {
        let paths = of_run(&self.metadata).map(|history| history.short_path_of(&self.metadata, None));
        [TIME.to_owned()].into_iter().chain(paths).collect()
    }

    fn __len__(&self) -> usize {
        1 + of_run(&self.metadata).count()
    }

    fn __contains__(&self, path: &str) -> bool {
        self.keys().iter().any(|known| known == path)
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.keys().into_pyobject(py)?.call_method0("__iter__")
    }

    fn __getitem__<'py>(&self, py: Python<'py>, path: &str) -> PyResult<Bound<'py, PyAny>> {
        if path == TIME {
            return Ok(self.row.time.into_pyobject(py)?.into_any());
        }
        let metadata = &*self.metadata;
        for history in of_run(metadata) {
            let is_it = |place: Option<&str>| history.short_path_of(metadata, place) == path;
            if is_it(None) {
                return of_row(py, history, metadata, &self.row);
            }
            // points/NAME/velocity
            if let Some(number) = history.places(metadata).iter().position(|place| is_it(Some(place))) {
                return of_row(py, history, metadata, &self.row)?.get_item(number);
            }
        }
        Err(PyKeyError::new_err(format!("{path:?} is no column of this run; it has {}", self.keys().join(", "))))
    }

    fn __repr__(&self) -> String {
        format!("Row(time {} {})", self.row.time, self.metadata.units.time)
    }
}
