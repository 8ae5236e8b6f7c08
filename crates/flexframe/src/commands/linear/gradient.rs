//! `flexframe gradient`: rates of frequencies, effective masses and static answers with the numbers that a body is made with.

mod report;
mod responses;
mod table;

use std::path::{Path, PathBuf};

use model::{BuildError, BuildProgress, Builder, Parameter, RatesOf};
use scene::Scene;
use whole_file::write_whole;

pub use report::{GradientReport, ParameterReport, StaticReport};
pub use responses::ResponseReport;

use crate::commands::linear::frequencies::Frequencies;
use crate::commands::modes::unloaded_body;
use crate::files::write_error::WriteError;

const NAME: &str = "gradient.csv";
const RESPONSES: &str = "gradient_frf.csv";
/// The most frequencies.
const MAX_FREQUENCIES: usize = 100_000;

/// Settings of rates.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct GradientSettings {
    /// Names of the parameters; without any, all keys of materials and point masses.
    pub parameters: Vec<String>,
    /// Frequencies of the responses whose rates are wanted, too.
    pub frequencies: Option<Frequencies>,
}

/// Rates that could not be found.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum GradientError {
    /// The scene has none.
    #[error("{0}")]
    Build(#[from] BuildError),
    /// The frequencies are no range.
    #[error(
        "frequencies {start}:{end}:{count}: expected start:end:count, cycles per time, with 0 ≤ start < end and a count of 2 to {MAX_FREQUENCIES}, e.g. 1:2000:200"
    )]
    Frequencies { start: f64, end: f64, count: usize },
    /// The table cannot be written.
    #[error("{0}")]
    Write(#[from] WriteError),
}

/// The files that [`gradient`] writes to a folder.
pub fn files(folder: &Path, settings: &GradientSettings) -> Vec<PathBuf> {
    let responses = settings.frequencies.map(|_| folder.join(RESPONSES));
    std::iter::once(folder.join(NAME)).chain(responses).collect()
}

/// Finds the rates of a scene, and writes `gradient.csv` to a folder, and `gradient_frf.csv` where responses are asked for.
///
/// # Errors
/// [`GradientError`].
pub fn gradient(
    scene: &Scene,
    builder: &Builder,
    folder: &Path,
    settings: &GradientSettings,
    progress: impl FnMut(BuildProgress),
) -> Result<GradientReport, GradientError> {
    let mut report = rates(scene, builder, settings, progress)?;
    std::fs::create_dir_all(folder).map_err(WriteError::of(folder))?;
    let tables = [table::rows(&report), table::responses(&report)];
    for (path, text) in files(folder, settings).into_iter().zip(tables) {
        write_whole(&path, text).map_err(WriteError::of(&path))?;
        report.files.push(path);
    }
    Ok(report)
}

/// The same without files.
///
/// # Errors
/// [`GradientError`].
pub fn rates(
    scene: &Scene,
    builder: &Builder,
    settings: &GradientSettings,
    progress: impl FnMut(BuildProgress),
) -> Result<GradientReport, GradientError> {
    let frequencies = match settings.frequencies {
        Some(asked @ Frequencies { start, end, count }) => {
            asked.evenly(MAX_FREQUENCIES).ok_or(GradientError::Frequencies { start, end, count })?
        }
        None => Vec::new(),
    };
    let scene = &unloaded_body(scene).map_err(BuildError::from)?;
    let parameters = Parameter::named(scene, &settings.parameters).map_err(BuildError::from)?;
    let body = builder.varied(scene, progress)?;
    let found = body.rates(body.body(), &parameters, RatesOf::All)?;
    Ok(GradientReport::new(&body, &parameters, &found, frequencies))
}
