//! The check of a run by the full nonlinear body, as a dict.

use flexframe::check::{BodyCheck, CheckReport, RowCheck};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The bodies of a check by their names: rows that were checked, and the reason where there are none.
pub(crate) fn checked<'py>(py: Python<'py>, check: &CheckReport) -> PyResult<Bound<'py, PyDict>> {
    let data = PyDict::new(py);
    for BodyCheck { name, rows, not_checked } in &check.bodies {
        let of_body = PyDict::new(py);
        of_body.set_item("rows", rows.iter().map(|row| of_row(py, row)).collect::<PyResult<Vec<_>>>()?)?;
        of_body.set_item("not_checked", not_checked)?;
        data.set_item(name, of_body)?;
    }
    Ok(data)
}

fn of_row<'py>(py: Python<'py>, RowCheck { row, why, state }: &RowCheck) -> PyResult<Bound<'py, PyDict>> {
    let data = PyDict::new(py);
    data.set_item("row", row)?;
    data.set_item("time", state.time)?;
    data.set_item("why", why)?;
    data.set_item("error", state.error)?;
    data.set_item("error_of_largest", state.error_of_largest)?;
    data.set_item("drift", state.drift)?;
    data.set_item("drift_mend", state.drift_mend.map(flexframe::model::Mend::words))?;
    let parts = PyDict::new(py);
    for part in &state.parts {
        parts.set_item(part.direction.words(), (part.size, part.mend.map(flexframe::model::Mend::words)))?;
    }
    data.set_item("parts", parts)?;
    let points = PyDict::new(py);
    for point in &state.points {
        points.set_item(&point.name, (point.displacement, point.error))?;
    }
    data.set_item("points", points)?;
    let frequencies: Vec<(f64, f64)> = state.frequencies.iter().map(|found| (found.model, found.full)).collect();
    data.set_item("frequencies", frequencies)?;
    data.set_item("negative_directions", state.negative_directions)?;
    data.set_item("growth", state.growth)?;
    Ok(data)
}
