//! `flexframe gradient`: rates of frequencies, effective masses and static answers with the numbers that a body is made with.

mod alone;
mod damping;
pub(crate) mod found;
mod here;
pub(crate) mod number;
mod report;
mod responses;
pub(crate) mod system;
mod system_responses;
mod varying;

use ::report::{File, Report};
use diagnostic::Failure;
use model::{BuildProgress, Builder};
use scene::Scene;

use self::report::Rates;
use crate::commands::linear::frequencies::Frequencies;
use number::Number;
use system::Varied;

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
    scene: &Scene,
    builder: &Builder,
    settings: &GradientSettings,
    progress: impl FnMut(BuildProgress),
) -> Result<Report, Failure> {
    let frequencies = match settings.frequencies {
        Some(asked) => asked.evenly(MAX_FREQUENCIES)?,
        None => Vec::new(),
    };
    let numbers = Number::named(scene, &settings.parameters)?;
    let found = match Varied::new(scene, builder, progress)? {
        Varied::System(varied) => varied.rates(scene, &numbers, &frequencies)?,
        Varied::Body(body) => alone::rates(&body, &numbers, &frequencies)?,
    };
    Ok(Rates::new(scene, &numbers, found, frequencies).report(scene))
}
