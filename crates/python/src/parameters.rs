//! Rates with the numbers of a scene and their fits, as the program reports them, for `parameters.py`.

use std::path::PathBuf;

use flexframe::fit::{self, FitSettings};
use flexframe::frequencies::Frequencies;
use flexframe::gradient::{self, GradientSettings};
use flexframe::model::BuildProgress;
use flexframe::scene::{Measured, MeasuredMode};
use pyo3::prelude::*;
use serde::Serialize;

use crate::body::built;
use crate::errors::{exception, wrong_input};
use crate::scene::Scene;

/// The name of measured frequencies that no file has.
const MEASURED: &str = "measured";

/// The report of `flexframe gradient`, in JSON.
#[pyfunction]
#[pyo3(signature = (scene, *, parameters, frequencies))]
pub(crate) fn gradients(
    py: Python<'_>,
    scene: Py<Scene>,
    parameters: Vec<String>,
    frequencies: Option<(f64, f64, usize)>,
) -> PyResult<String> {
    let frequencies = frequencies.map(|(start, end, count)| Frequencies { start, end, count });
    let settings = GradientSettings { parameters, frequencies };
    let (whole, builder) = (scene.get().whole().clone(), scene.get().builder().clone());
    let work = move |told: &mut dyn FnMut(BuildProgress)| gradient::gradient(&whole, &builder, &settings, told);
    json(&built(py, &scene, work)?)
}

/// The report of `flexframe fit`, in JSON, by the table in a file or by frequencies in the order of the modes.
#[pyfunction]
#[pyo3(signature = (scene, *, parameters, file, measured, deviation))]
pub(crate) fn fitted(
    py: Python<'_>,
    scene: Py<Scene>,
    parameters: Vec<String>,
    file: Option<PathBuf>,
    measured: Option<Vec<f64>>,
    deviation: Option<f64>,
) -> PyResult<String> {
    let measured = match (file, measured) {
        (Some(file), _) => Some(Measured::read(&file).map_err(|error| exception(py, &error))?),
        (None, Some(frequencies)) => Some(in_order(py, &frequencies)?),
        (None, None) => None,
    };
    let settings = FitSettings { parameters, measured, deviation };
    let (whole, builder) = (scene.get().whole().clone(), scene.get().builder().clone());
    let work = move |told: &mut dyn FnMut(BuildProgress)| fit::fit(&whole, &builder, &settings, None, told);
    json(&built(py, &scene, work)?)
}

fn in_order(py: Python<'_>, frequencies: &[f64]) -> PyResult<Measured> {
    let expected = "positive frequencies, one or more";
    let help = "give them in the order of the modes, cycles per time";
    if frequencies.is_empty() {
        return Err(wrong_input(py, MEASURED, "none", expected, help));
    }
    let mode = |(i, frequency): (usize, &f64)| match frequency.is_finite() && *frequency > 0.0 {
        true => Ok(MeasuredMode {
            line: i + 1,
            frequency: *frequency,
            deviation: None,
            damping_ratio: None,
            shape: Vec::new(),
        }),
        false => Err(wrong_input(py, &format!("{MEASURED}[{i}]"), &frequency.to_string(), expected, help)),
    };
    let modes = frequencies.iter().enumerate().map(mode).collect::<PyResult<_>>()?;
    Ok(Measured { file: PathBuf::from(MEASURED), places: Vec::new(), modes })
}

fn json(report: &impl Serialize) -> PyResult<String> {
    serde_json::to_string(report).map_err(|error| pyo3::exceptions::PyRuntimeError::new_err(error.to_string()))
}
