//! Data of the class Results, which is written in Python.

use std::path::PathBuf;

use flexframe::columns::COLUMNS;
use flexframe::results::{BodyMetadata, Metadata, Results, TrustLine};
use flexframe::row::Row;
use numpy::{IntoPyArray, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::errors::exception;
use crate::rows::columns::{History, dimensions, of_run, scope, shaped};
use crate::scene::units;
use crate::threads::detached;

/// The module of the class.
const MODULE: &str = "flexframe.results";

/// The rows of a run, in memory.
pub(crate) struct Rows {
    times: Vec<f64>,
    histories: Vec<(History, Vec<f64>)>,
}

/// An event that a run has come to: its name and the time.
pub(crate) type Occurred = (String, f64);

impl Rows {
    pub(crate) fn new(metadata: &Metadata) -> Self {
        Self { times: Vec::new(), histories: of_run(metadata).map(|history| (history, Vec::new())).collect() }
    }

    pub(crate) fn push(&mut self, row: &Row, metadata: &Metadata) {
        self.times.push(row.time);
        self.histories.iter_mut().for_each(|(history, values)| history.append(row, metadata, values));
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
        data.set_item("complete", complete)?;
        data.set_item("warnings", &metadata.warnings)?;
        let trust = metadata.trust.iter().map(|line| of_trust(py, line)).collect::<PyResult<Vec<_>>>()?;
        data.set_item("trust", trust)?;
        data.set_item("events", events)?;
        let bodies = metadata.bodies.iter().map(|body| of_body(py, body)).collect::<PyResult<Vec<_>>>()?;
        data.set_item("bodies", bodies)?;

        let columns = PyList::empty(py);
        let time = (&metadata.units.time, "none", "time of each row", vec!["time"], "system", None::<&str>);
        let rows = self.times.len();
        columns.append(("time", "time", time, shaped(py, self.times, &[rows])?))?;
        for (history, values) in self.histories {
            let column = history.column;
            let shape: Vec<usize> = [rows].into_iter().chain(history.row_shape(metadata)).collect();
            let dimensions = dimensions(history);
            let names: Vec<&str> = ["time"].into_iter().chain(dimensions.iter().map(String::as_str)).collect();
            let (unit, body) = (column.unit(&metadata.units), history.body(metadata).map(|body| body.name.as_str()));
            let described = (unit, column.frame, column.description, names, scope(history), body);
            let path = history.short_path_of(metadata, None);
            let own_path = column.path_of(None);
            columns.append((path, own_path, described, shaped(py, values, &shape)?))?;
        }
        data.set_item("columns", columns)?;
        py.import(MODULE)?.getattr("Results")?.call1((data,))
    }
}

/// A line of the trust card.
fn of_trust<'py>(py: Python<'py>, line: &TrustLine) -> PyResult<Bound<'py, PyDict>> {
    let TrustLine { place, body, error, meaning, known, next } = line;
    let data = PyDict::new(py);
    data.set_item("place", place)?;
    data.set_item("body", body)?;
    data.set_item("error", error)?;
    data.set_item("meaning", meaning)?;
    data.set_item("known", known)?;
    data.set_item("next", next)?;
    Ok(data)
}

/// Properties of a body besides its columns.
fn of_body<'py>(py: Python<'py>, body: &BodyMetadata) -> PyResult<Bound<'py, PyDict>> {
    let data = PyDict::new(py);
    data.set_item("name", &body.name)?;
    data.set_item("frequencies", body.model.frequencies.clone().into_pyarray(py))?;
    data.set_item("damping_ratios", body.model.damping_ratios.clone().into_pyarray(py))?;
    data.set_item("kinds", body.model.kinds().collect::<Vec<_>>())?;
    data.set_item("points", &body.point_names)?;
    let positions = body.point_positions.as_flattened().to_vec();
    data.set_item("point_positions", positions.into_pyarray(py).reshape([body.point_names.len(), 3])?)?;
    data.set_item("supports", &body.support_names)?;
    Ok(data)
}

/// Reads a results file, finished or not.
#[pyfunction]
pub(crate) fn read_results(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyAny>> {
    let read = detached(py, || Results::open(&path, &COLUMNS))?.map_err(|error| exception(py, &error))?;
    let metadata = &read.metadata;
    let times = read.numbers("time").unwrap_or_default().to_vec();
    let histories = of_run(metadata).map(|history| (history, read.dataset(history))).collect();
    Rows { times, histories }.into_results(py, metadata, read.complete, &[])
}
