//! Data of the class Results, which is written in Python.

use std::path::PathBuf;

use flexframe::columns::COLUMNS;
use flexframe::results::{Column, Metadata, Results, present};
use flexframe::row::Row;
use numpy::{IntoPyArray, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::columns::{dimensions, of_run, shaped};
use crate::errors::exception;
use crate::scene::units;
use crate::threads::detached;

/// The module of the class.
const MODULE: &str = "flexframe.results";

/// The rows of a run, in memory.
pub(crate) struct Rows {
    columns: Vec<(&'static Column<Row>, Vec<f64>)>,
    count: usize,
}

/// An event that a run has come to: its name and the time.
pub(crate) type Occurred = (String, f64);

impl Rows {
    pub(crate) fn new(metadata: &Metadata) -> Self {
        Self { columns: of_run(metadata).map(|column| (column, Vec::new())).collect(), count: 0 }
    }

    pub(crate) fn push(&mut self, row: &Row, metadata: &Metadata) {
        self.columns.iter_mut().for_each(|(column, values)| column.append(row, metadata, values));
        self.count += 1;
    }

    /// The results that they are; they become the arrays, without a copy.
    pub(crate) fn into_results<'py>(
        self,
        py: Python<'py>,
        metadata: &Metadata,
        complete: bool,
        events: &[Occurred],
    ) -> PyResult<Bound<'py, PyAny>> {
        let Metadata { title, formulation, scheme, step, tolerance, program_version, scene_text, scene_file, .. } =
            metadata;
        let data = PyDict::new(py);
        data.set_item("title", title)?;
        data.set_item("units", units(py, &metadata.units.length, &metadata.units.mass, &metadata.units.time)?)?;
        data.set_item("formulation", formulation)?;
        data.set_item("scheme", scheme)?;
        data.set_item("step", step)?;
        data.set_item("tolerance", tolerance)?;
        data.set_item("program_version", program_version)?;
        data.set_item("scene", scene_text)?;
        data.set_item("scene_file", scene_file)?;
        data.set_item("frequencies", metadata.body.frequencies.clone().into_pyarray(py))?;
        data.set_item("damping_ratios", metadata.body.damping_ratios.clone().into_pyarray(py))?;
        data.set_item("kinds", metadata.body.kinds().collect::<Vec<_>>())?;
        data.set_item("points", &metadata.point_names)?;
        let positions = metadata.point_positions.as_flattened().to_vec();
        data.set_item("point_positions", positions.into_pyarray(py).reshape([metadata.point_names.len(), 3])?)?;
        data.set_item("supports", &metadata.support_names)?;
        data.set_item("complete", complete)?;
        data.set_item("warnings", &metadata.warnings)?;
        data.set_item("events", events)?;

        let columns = PyList::empty(py);
        for (column, values) in self.columns {
            let shape: Vec<usize> = [self.count].into_iter().chain(column.row_shape(metadata)).collect();
            let names: Vec<String> = ["time".to_owned()].into_iter().chain(dimensions(column)).collect();
            let unit = column.unit(&metadata.units);
            let array = shaped(py, values, &shape)?;
            columns.append((column.path, unit, column.frame, column.description, names, array))?;
        }
        data.set_item("columns", columns)?;
        py.import(MODULE)?.getattr("Results")?.call1((data,))
    }
}

/// Reads a results file, finished or not.
#[pyfunction]
pub(crate) fn read_results(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyAny>> {
    let read = detached(py, || Results::open(&path, &COLUMNS))?.map_err(|error| exception(py, &error))?;
    let metadata = &read.metadata;
    let columns = present(&COLUMNS, metadata).map(|column| (column, read.dataset(column))).collect();
    Rows { columns, count: read.rows() }.into_results(py, metadata, read.complete, &[])
}
