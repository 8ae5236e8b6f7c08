//! `flexframe srs`: shock response spectra of a base motion, Eqs. (R1) and (R2) of `docs/method/shock.md`.

mod diagram;
mod error;
mod files;
mod page;
mod report;
pub(super) mod table;

use std::path::Path;

pub use scene::Interpolation;
use shock::Spectrum;

pub use error::SrsError;
pub use files::files;
pub use report::{DampingReport, SrsReport};

use crate::commands::linear::frequencies::Frequencies;
use error::{MAX_DAMPINGS, MAX_FREQUENCIES};

/// Settings of spectra.
#[derive(Debug, Clone, PartialEq)]
pub struct SrsSettings {
    /// The frequencies, at equal ratios.
    pub frequencies: Frequencies,
    /// Damping ratios: a spectrum for each.
    pub damping_ratios: Vec<f64>,
    /// The way of the acceleration from row to row.
    pub interpolation: Interpolation,
}

/// Computes the spectra of the base motion in a CSV file, and writes `srs.csv`, the page `srs.html`, and `srs` as SVG, PDF
/// and PNG to `folder`.
///
/// # Errors
/// [`SrsError`].
pub fn srs(table: &Path, folder: &Path, settings: &SrsSettings) -> Result<SrsReport, SrsError> {
    let Frequencies { start, end, count } = settings.frequencies;
    let frequencies = settings.frequencies.by_ratios(MAX_FREQUENCIES);
    let frequencies = frequencies.ok_or(SrsError::Frequencies { start, end, count })?;
    if !(1..=MAX_DAMPINGS).contains(&settings.damping_ratios.len()) {
        return Err(SrsError::Dampings { count: settings.damping_ratios.len() });
    }
    let motion = table::read(table, settings.interpolation)?;
    let of = |ratio: &f64| motion.spectrum(&frequencies, *ratio);
    let spectra = settings.damping_ratios.iter().map(of).collect::<Result<Vec<Spectrum>, _>>();
    let spectra = spectra.map_err(|source| SrsError::Shock { table: table.to_owned(), source })?;
    let files = files::write((table, settings.interpolation), &spectra, folder)?;
    Ok(SrsReport::new((table, settings.interpolation), &motion, &spectra, files))
}
