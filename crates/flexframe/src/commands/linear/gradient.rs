//! `flexframe gradient`: rates of frequencies, effective masses and static answers with the numbers that a body is made with.

mod damping;
mod here;
pub(crate) mod number;
mod report;
mod responses;
pub(crate) mod system;
mod system_responses;
mod table;
mod varying;

use std::path::{Path, PathBuf};

use diagnostic::Failure;
use model::{BuildError, BuildProgress, Builder, Needs, Parameter, RatesOf};
use scene::System;
use whole_file::write_whole;

pub use report::{GradientReport, ParameterReport, StaticReport};
pub use responses::ResponseReport;

use crate::commands::linear::frequencies::Frequencies;
use crate::commands::modes::lone_body;
use crate::files::write_error::WriteError;
use number::Number;
use system::VariedSystem;

const NAME: &str = "gradient.csv";
const RESPONSES: &str = "gradient_frf.csv";
/// The most frequencies of responses.
const MAX_FREQUENCIES: usize = 100_000;

/// Settings of rates.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct GradientSettings {
    /// Names of the parameters; without any, all keys of materials and point masses.
    pub parameters: Vec<String>,
    /// Frequencies of the responses whose rates are wanted, too.
    pub frequencies: Option<Frequencies>,
}

/// The files that [`gradient`] writes to a folder.
pub fn files(folder: &Path, settings: &GradientSettings) -> Vec<PathBuf> {
    let responses = settings.frequencies.map(|_| folder.join(RESPONSES));
    std::iter::once(folder.join(NAME)).chain(responses).collect()
}

/// Finds the rates of a scene of one body, or of bodies in joints, and writes `gradient.csv` to a folder, and `gradient_frf.csv` where responses are asked for.
///
/// # Errors
/// [`Failure`].
pub fn gradient(
    system: &System,
    builder: &Builder,
    folder: &Path,
    settings: &GradientSettings,
    progress: impl FnMut(BuildProgress),
) -> Result<GradientReport, Failure> {
    let mut report = rates(system, builder, settings, progress)?;
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
/// [`Failure`].
pub fn rates(
    system: &System,
    builder: &Builder,
    settings: &GradientSettings,
    progress: impl FnMut(BuildProgress),
) -> Result<GradientReport, Failure> {
    let frequencies = match settings.frequencies {
        Some(asked) => asked.evenly(MAX_FREQUENCIES)?,
        None => Vec::new(),
    };
    if system.has_connections() {
        let parameters = Number::named(system, &settings.parameters)?;
        let varied = VariedSystem::new(system, builder, progress)?;
        let found = varied.rates(system, &parameters, &frequencies)?;
        return Ok(GradientReport::of_system(system, &parameters, found, frequencies));
    }
    let scene = lone_body(system).map_err(BuildError::from)?;
    let parameters = Parameter::named(scene, &settings.parameters).map_err(BuildError::from)?;
    let body = builder.needing(Needs::modes()).varied(scene, progress)?;
    let found = body.rates(body.body(), &parameters, RatesOf::All)?;
    Ok(GradientReport::new(&body, &parameters, &found, frequencies))
}
