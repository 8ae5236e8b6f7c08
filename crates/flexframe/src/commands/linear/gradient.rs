//! `flexframe gradient`: rates of frequencies, effective masses and static answers with the numbers that a body is made with.

mod damping;
mod here;
pub(crate) mod number;
mod report;
mod responses;
pub(crate) mod system;
mod system_responses;
mod varying;

use ::report::{File, Report};
use diagnostic::Failure;
use model::{BuildError, BuildProgress, Builder, Needs, Parameter, RatesOf};
use scene::System;

use self::report::Rates;
use crate::commands::linear::frequencies::Frequencies;
use crate::commands::modes::lone_body;
use number::Number;
use system::VariedSystem;

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

/// The files of [`gradient`]: `gradient.csv`, and `gradient_frf.csv` where responses are asked for.
pub fn files(settings: &GradientSettings) -> Vec<File> {
    let responses = settings.frequencies.map(|_| File::Table("gradient_frf"));
    std::iter::once(File::Table("gradient")).chain(responses).collect()
}

/// Finds the rates of a scene of one body, or of bodies in joints.
///
/// # Errors
/// [`Failure`].
pub fn gradient(
    system: &System,
    builder: &Builder,
    settings: &GradientSettings,
    progress: impl FnMut(BuildProgress),
) -> Result<Report, Failure> {
    let frequencies = match settings.frequencies {
        Some(asked) => asked.evenly(MAX_FREQUENCIES)?,
        None => Vec::new(),
    };
    if system.has_connections() {
        let parameters = Number::named(system, &settings.parameters)?;
        let varied = VariedSystem::new(system, builder, progress)?;
        let found = varied.rates(system, &parameters, &frequencies)?;
        return Ok(Rates::of_system(system, &parameters, found, frequencies).report(system));
    }
    let scene = lone_body(system).map_err(BuildError::from)?;
    let parameters = Parameter::named(scene, &settings.parameters).map_err(BuildError::from)?;
    let body = builder.needing(Needs::modes()).varied(scene, progress)?;
    let found = body.rates(body.body(), &parameters, RatesOf::All)?;
    Ok(Rates::new(&body, &parameters, &found, frequencies).report(scene))
}
