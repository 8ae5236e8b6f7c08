//! `flexframe srs`: shock response spectra of a base motion, Eqs. (R1) and (R2) of `docs/method/shock.md`.

mod diagram;
mod error;
mod files;
mod report;
mod table;

use std::path::Path;

use shock::Spectrum;

pub use error::SrsError;
pub use files::files;
pub use report::{DampingReport, SrsReport};

use error::{MAX_DAMPINGS, MAX_FREQUENCIES};

/// Frequencies at equal ratios, both ends included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frequencies {
    /// The lowest, cycles per time, > 0.
    pub start: f64,
    /// The highest.
    pub end: f64,
    /// How many, 2 to 10 000.
    pub count: usize,
}

impl Frequencies {
    fn values(&self) -> Result<Vec<f64>, SrsError> {
        let &Self { start, end, count } = self;
        if !(start > 0.0 && end > start && end.is_finite() && (2..=MAX_FREQUENCIES).contains(&count)) {
            return Err(SrsError::Frequencies { start, end, count });
        }
        let last = (count - 1) as f64;
        let inner = (1..count - 1).map(|k| start * (end / start).powf(k as f64 / last));
        Ok(std::iter::once(start).chain(inner).chain([end]).collect())
    }
}

/// Settings of spectra.
#[derive(Debug, Clone, PartialEq)]
pub struct SrsSettings {
    /// The frequencies.
    pub frequencies: Frequencies,
    /// Damping ratios: a spectrum for each.
    pub damping_ratios: Vec<f64>,
}

/// Computes the spectra of the base motion in a CSV file, and writes `srs.csv`, and `srs` as SVG, PDF and PNG to `folder`.
///
/// # Errors
/// [`SrsError`].
pub fn srs(table: &Path, folder: &Path, settings: &SrsSettings) -> Result<SrsReport, SrsError> {
    let frequencies = settings.frequencies.values()?;
    if !(1..=MAX_DAMPINGS).contains(&settings.damping_ratios.len()) {
        return Err(SrsError::Dampings { count: settings.damping_ratios.len() });
    }
    let motion = table::read(table)?;
    let of = |ratio: &f64| motion.spectrum(&frequencies, *ratio);
    let spectra = settings.damping_ratios.iter().map(of).collect::<Result<Vec<Spectrum>, _>>();
    let spectra = spectra.map_err(|source| SrsError::Shock { table: table.to_owned(), source })?;
    let files = files::write(table, &spectra, folder)?;
    Ok(SrsReport::new(table, &motion, &spectra, files))
}
