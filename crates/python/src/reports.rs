//! Reports of the commands on small motions, with the data, tables, text and figures of the program, for `commands.py`.

use std::path::PathBuf;

use flexframe::campbell::{self, AboutRest, CampbellProgress, CampbellSettings, Speeds};
use flexframe::frequencies::Frequencies;
use flexframe::frf::{self, FrfSettings};
use flexframe::linearize::LinearSettings;
use flexframe::model::BuildProgress;
use flexframe::psd::{self, PsdSettings};
use flexframe::report::{File, Value, program};
use flexframe::shock;
use flexframe::srs::{self, Interpolation, SrsSettings};
use numpy::PyArray1;
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::body::built;
use crate::errors::{exception, wrong_input};
use crate::scene::Scene;
use crate::values::html::escaped;

/// The report of a command.
///
/// `report["peaks[0].magnitude"]` is a value by its path in the JSON of the program, `table(name)` a table as columns of numpy, `str(report)`
/// the text of the program. In a notebook it shows its figure and its text.
#[pyclass(frozen, module = "flexframe", name = "Report")]
pub(crate) struct CommandReport {
    report: flexframe::report::Report,
    files: &'static [File],
}

#[pymethods]
impl CommandReport {
    /// Title of the scene.
    #[getter]
    fn title(&self) -> Option<&str> {
        self.report.title.as_deref()
    }

    /// Reservations of the program.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.report.warnings.clone()
    }

    /// Names of the tables.
    #[getter]
    fn tables(&self) -> Vec<&str> {
        let mut names: Vec<&str> = self.report.tables().map(|table| table.name).collect();
        names.dedup();
        names
    }

    fn __getitem__<'py>(&self, py: Python<'py>, path: &str) -> PyResult<Bound<'py, PyAny>> {
        let value = self.report.value(path).ok_or_else(|| PyKeyError::new_err(path.to_owned()))?;
        loaded(py, &value.to_string())
    }

    /// The whole JSON of the program as a dict.
    fn data<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        loaded(py, &self.report.json().to_string())
    }

    /// A table as a dict of columns: arrays of numbers, NaN where there is none, and lists of words.
    fn table<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyDict>> {
        let table = self.report.table_named(name).ok_or_else(|| PyKeyError::new_err(name.to_owned()))?;
        let columns = PyDict::new(py);
        for (key, values) in table.columns() {
            match values.iter().map(number).collect::<Option<Vec<f64>>>() {
                Some(numbers) => columns.set_item(key, PyArray1::from_vec(py, numbers))?,
                None => {
                    let json: Vec<String> = values.iter().map(|value| value.json().to_string()).collect();
                    columns.set_item(key, loaded(py, &format!("[{}]", json.join(",")))?)?;
                }
            }
        }
        Ok(columns)
    }

    /// A table as a DataFrame of pandas, which has to be installed.
    fn to_pandas<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        py.import("pandas")?.getattr("DataFrame")?.call1((self.table(py, name)?,))
    }

    /// Writes the files of the command to a folder, which is made if it does not exist: tables as CSV, figures as SVG, PDF and PNG, the page.
    /// Files of the same names are replaced.
    fn save(&self, py: Python<'_>, folder: PathBuf) -> PyResult<Vec<PathBuf>> {
        let mut report = self.report.clone();
        py.detach(|| report.write(self.files, &folder, &program())).map_err(|error| exception(py, &*error))?;
        Ok(report.files)
    }

    /// The figure as SVG; None where there is nothing to draw.
    fn svg(&self, py: Python<'_>) -> PyResult<Option<String>> {
        let figure = self.files.iter().find_map(|file| match file {
            File::Chart(name) => self.report.figure(name),
            _ => None,
        });
        figure.map(|figure| figure.svg()).transpose().map_err(|error| exception(py, &error))
    }

    fn __str__(&self) -> String {
        self.report.to_string()
    }

    fn __repr__(&self) -> String {
        format!("Report({:?}, tables={:?})", self.title().unwrap_or_default(), self.tables())
    }

    fn _repr_html_(&self, py: Python<'_>) -> PyResult<String> {
        let figure = self.svg(py)?.unwrap_or_default();
        Ok(format!("{figure}<pre>{}</pre>", escaped(&self.report.to_string())))
    }
}

fn loaded<'py>(py: Python<'py>, json: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("json")?.call_method1("loads", (json,))
}

/// A number, or NaN where there is none; no number for words and lists.
fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Number(number) => Some(*number),
        Value::Json(json) if json.is_null() => Some(f64::NAN),
        Value::Json(json) => json.as_f64(),
        Value::List(_) => None,
    }
}

/// The state that equations are about, and their channels.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct About {
    spin: Option<[f64; 3]>,
    time: Option<f64>,
    without_rigid: bool,
    inputs: Vec<String>,
    outputs: Vec<String>,
}

impl From<About> for LinearSettings {
    fn from(About { spin, time, without_rigid, inputs, outputs }: About) -> Self {
        Self { spin, time, without_rigid, inputs, outputs }
    }
}

/// The report of `flexframe frf`.
#[pyfunction]
pub(crate) fn frf_report(
    py: Python<'_>,
    scene: Py<Scene>,
    about: About,
    frequencies: (f64, f64, usize),
    logarithmic: bool,
    structural: Option<f64>,
) -> PyResult<CommandReport> {
    let (start, end, count) = frequencies;
    let frequencies = Frequencies { start, end, count };
    let settings = FrfSettings { linear: about.into(), frequencies, logarithmic, loss_factor: structural };
    let (whole, builder) = (scene.get().whole().clone(), scene.get().builder().clone());
    let work = move |told: &mut dyn FnMut(BuildProgress)| frf::frf(&whole, &builder, &settings, told);
    Ok(CommandReport { report: built(py, &scene, work)?, files: &frf::FILES })
}

/// The report of `flexframe psd`.
#[pyfunction]
pub(crate) fn psd_report(
    py: Python<'_>,
    scene: Py<Scene>,
    about: About,
    spectra: PathBuf,
    band: Option<[f64; 2]>,
    structural: Option<f64>,
) -> PyResult<CommandReport> {
    let settings = PsdSettings { linear: about.into(), band, loss_factor: structural };
    let (whole, builder) = (scene.get().whole().clone(), scene.get().builder().clone());
    let work = move |told: &mut dyn FnMut(BuildProgress)| psd::psd(&whole, &builder, &spectra, &settings, told);
    Ok(CommandReport { report: built(py, &scene, work)?, files: &psd::FILES })
}

/// The report of `flexframe shock`.
#[pyfunction]
pub(crate) fn shock_report(
    py: Python<'_>,
    scene: Py<Scene>,
    about: About,
    table: PathBuf,
    interpolation: &str,
) -> PyResult<CommandReport> {
    let settings = LinearSettings::from(about);
    let interpolation = interpolation_of(py, interpolation)?;
    let (whole, builder) = (scene.get().whole().clone(), scene.get().builder().clone());
    let work = move |told: &mut dyn FnMut(BuildProgress)| {
        shock::shock(&whole, &builder, (&table, interpolation), &settings, told)
    };
    Ok(CommandReport { report: built(py, &scene, work)?, files: &[] })
}

/// The report of `flexframe srs`.
#[pyfunction]
pub(crate) fn srs_report(
    py: Python<'_>,
    table: PathBuf,
    frequencies: (f64, f64, usize),
    damping_ratios: Vec<f64>,
    interpolation: &str,
) -> PyResult<CommandReport> {
    let (start, end, count) = frequencies;
    let interpolation = interpolation_of(py, interpolation)?;
    let settings = SrsSettings { frequencies: Frequencies { start, end, count }, damping_ratios, interpolation };
    let report = py.detach(|| srs::srs(&table, &settings)).map_err(|error| exception(py, &*error))?;
    Ok(CommandReport { report, files: &srs::FILES })
}

/// The report of `flexframe campbell`.
#[pyfunction]
pub(crate) fn campbell_report(
    py: Python<'_>,
    scene: Py<Scene>,
    speeds: (f64, f64, usize),
    about: (Option<[f64; 3]>, Option<String>),
    orders: Vec<f64>,
    about_rest: &str,
) -> PyResult<CommandReport> {
    let ((start, end, count), (axis, joint)) = (speeds, about);
    let speeds = Speeds { start, end, count };
    let about_rest = match about_rest {
        "auto" => AboutRest::Auto,
        "always" => AboutRest::Always,
        "never" => AboutRest::Never,
        other => return Err(wrong_input(py, "about_rest", other, "auto, always or never", "give one of them")),
    };
    let (whole, builder) = (scene.get().whole().clone(), scene.get().builder().clone());
    let settings = CampbellSettings { axis, joint, speeds, orders, about_rest };
    let work = move |told: &mut dyn FnMut(BuildProgress)| {
        campbell::campbell(&whole, &builder, &settings, |progress| {
            if let CampbellProgress::Build(progress) = progress {
                told(progress);
            }
        })
    };
    Ok(CommandReport { report: built(py, &scene, work)?, files: &campbell::FILES })
}

fn interpolation_of(py: Python<'_>, name: &str) -> PyResult<Interpolation> {
    match name {
        "linear" => Ok(Interpolation::Linear),
        "monotone-cubic" => Ok(Interpolation::MonotoneCubic),
        other => Err(wrong_input(py, "interpolation", other, "linear or monotone-cubic", "give one of them")),
    }
}
