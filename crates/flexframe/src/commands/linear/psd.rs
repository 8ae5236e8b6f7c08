//! `flexframe psd`: the response of a scene to stationary random inputs, Eqs. (F6) to (F8) of `docs/method/linear.md`.

mod files;
mod page;
mod report;
mod responses;

use std::path::Path;

use diagnostic::{Diagnostic, Failure};
use linear::{LinearError, Quadrature};
use model::{BuildProgress, Builder};
use scene::System;

pub use files::files;
pub use report::{PsdReport, RandomOutput};

use crate::commands::linear::frf::{damping_of, structural};
use crate::commands::linear::linearize::{LinearSettings, linear_model};
use crate::commands::linear::spectra::Spectra;
use responses::Responses;

/// Settings of random responses.
#[derive(Debug, Clone, PartialEq)]
pub struct PsdSettings {
    /// The state that the equations are about, and the outputs. Inputs are those of the table.
    pub linear: LinearSettings,
    /// Lowest and highest frequency, cycles per time; those of the table where there are none.
    pub band: Option<[f64; 2]>,
    /// Loss factor of structural damping in the place of the scene's damping.
    pub loss_factor: Option<f64>,
}

/// Computes the response of a scene to the random inputs in a CSV file, and writes `psd.csv`, the page `psd.html`, and `psd` as SVG, PDF and
/// PNG to a folder.
///
/// # Errors
/// [`Failure`].
pub fn psd(
    system: &System,
    builder: &Builder,
    table: &Path,
    folder: &Path,
    settings: &PsdSettings,
    progress: impl FnMut(BuildProgress),
) -> Result<PsdReport, Failure> {
    let spectra = Spectra::read(table)?;
    let band = spectra.band(settings.band)?;
    let asked = LinearSettings { inputs: spectra.inputs(), ..settings.linear.clone() };
    let mut model = linear_model(system, builder, &asked, progress)?;
    if let Some(loss_factor) = settings.loss_factor {
        model.state.damping = structural(loss_factor);
    }
    let failed = |source: LinearError| source.in_file(&system.path);
    let damping = damping_of(settings.loss_factor);
    let poles = model.equations.poles(damping).map_err(failed)?;
    let rule = Quadrature::of_poles(band, &spectra.frequencies(), &poles).map_err(failed)?;
    let names: Vec<&str> = model.equations.inputs.iter().map(|input| &input.name[..]).collect();
    let input = spectra.at(&names, &rule.frequencies)?;
    let response = model.equations.frequency_response(&rule.frequencies, damping).map_err(failed)?;
    let responses = Responses::new(&model.equations, &response, &input, &rule.weights).map_err(failed)?;
    let mut report = PsdReport::new(system, &model, band, &responses);
    let page = page::page(system, &model.state, &report, &responses, &rule.weights);
    report.files = files::write(&system.title, &system.units.time, &responses, page, folder)?;
    Ok(report)
}
