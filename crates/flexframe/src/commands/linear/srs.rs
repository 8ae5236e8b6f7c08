//! `flexframe srs`: shock response spectra of a base motion, Eqs. (R1) and (R2) of `docs/method/shock.md`.

mod diagram;
mod files;
mod page;
mod report;
pub(super) mod table;

use std::path::Path;

use diagnostic::{Diagnostic, Failure, Kind};
pub use scene::Interpolation;
use shock::Spectrum;

pub use files::files;
pub use report::{DampingReport, SrsReport};

use crate::commands::linear::frequencies::Frequencies;

/// Each frequency takes a run of an oscillator for each damping ratio.
const MAX_FREQUENCIES: usize = 10_000;
/// More lines than this have no colours of their own.
const MAX_DAMPINGS: usize = 7;

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
/// [`Failure`].
pub fn srs(table: &Path, folder: &Path, settings: &SrsSettings) -> Result<SrsReport, Failure> {
    let frequencies = settings.frequencies.by_ratios(MAX_FREQUENCIES)?;
    let count = settings.damping_ratios.len();
    if !(1..=MAX_DAMPINGS).contains(&count) {
        let wrong = Kind::Usage.alone().key("damping").found(format!("{count} damping ratios"));
        return Err(wrong.expected(format!("1 to {MAX_DAMPINGS}")).help("give some, such as 0.02,0.05").into());
    }
    let motion = table::read(table, settings.interpolation)?;
    let of = |ratio: &f64| motion.spectrum(&frequencies, *ratio);
    let spectra = settings.damping_ratios.iter().map(of).collect::<Result<Vec<Spectrum>, _>>();
    let spectra = spectra.map_err(|source| source.in_file(table))?;
    let files = files::write((table, settings.interpolation), &spectra, folder)?;
    Ok(SrsReport::new((table, settings.interpolation), &motion, &spectra, files))
}
