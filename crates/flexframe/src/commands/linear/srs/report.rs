//! Report of shock response spectra.

use std::fmt;
use std::path::{Path, PathBuf};

use scene::Interpolation;
use serde::Serialize;
use shock::{BaseMotion, Peaks, Spectrum};

use crate::files::json;
use crate::report::quantity;

/// Shock response spectra of a base motion.
#[derive(Debug, Clone, Serialize)]
pub struct SrsReport {
    /// The table of the base motion.
    #[serde(serialize_with = "json::path")]
    pub table: PathBuf,
    /// The way of the acceleration from row to row.
    pub interpolation: Interpolation,
    /// Time from its first row to its last.
    pub duration: f64,
    /// Largest magnitude of the acceleration of the base.
    pub base_peak: f64,
    /// Frequencies, cycles per time.
    pub frequencies: Vec<f64>,
    /// A spectrum for each damping ratio.
    pub spectra: Vec<DampingReport>,
    /// Files written.
    #[serde(serialize_with = "json::paths")]
    pub files: Vec<PathBuf>,
}

/// The spectrum of one damping ratio.
#[derive(Debug, Clone, Serialize)]
pub struct DampingReport {
    /// Damping ratio.
    pub damping_ratio: f64,
    /// Largest magnitude of the displacement relative to the base, at each frequency.
    pub displacement: Vec<f64>,
    /// Largest acceleration of the mass, at each frequency.
    pub acceleration_largest: Vec<f64>,
    /// Least acceleration of the mass, at each frequency.
    pub acceleration_least: Vec<f64>,
}

impl SrsReport {
    pub(super) fn new(
        (table, interpolation): (&Path, Interpolation),
        motion: &BaseMotion,
        spectra: &[Spectrum],
        files: Vec<PathBuf>,
    ) -> Self {
        let of = |spectrum: &Spectrum| {
            let list = |of: fn(&Peaks) -> f64| spectrum.peaks.iter().map(of).collect();
            DampingReport {
                damping_ratio: spectrum.damping_ratio,
                displacement: list(|peaks| peaks.displacement),
                acceleration_largest: list(|peaks| peaks.acceleration_largest),
                acceleration_least: list(|peaks| peaks.acceleration_least),
            }
        };
        Self {
            table: table.to_owned(),
            interpolation,
            duration: motion.duration(),
            base_peak: motion.peak(),
            frequencies: spectra.first().map(|spectrum| spectrum.frequencies.clone()).unwrap_or_default(),
            spectra: spectra.iter().map(of).collect(),
            files,
        }
    }
}

impl DampingReport {
    /// The largest magnitude of the acceleration of the mass, and the place of its frequency.
    fn worst(&self) -> (usize, f64) {
        let both = self.acceleration_largest.iter().zip(&self.acceleration_least);
        let magnitudes = both.map(|(largest, least)| largest.max(-least)).enumerate();
        magnitudes.fold((0, 0.0), |most, here| if here.1 > most.1 { here } else { most })
    }
}

impl fmt::Display for SrsReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.table.display())?;
        let [duration, peak] = [self.duration, self.base_peak].map(quantity);
        let between = self.interpolation.words();
        writeln!(
            f,
            "  base     {duration} long, peak acceleration {peak}, {between} between rows, zero after the last"
        )?;
        for spectrum in &self.spectra {
            let (at, worst) = spectrum.worst();
            let frequency = self.frequencies.get(at).copied().unwrap_or_default();
            write!(f, "  ζ = {:<5}largest acceleration of the mass {}", spectrum.damping_ratio, quantity(worst))?;
            if self.base_peak > 0.0 {
                write!(f, ", {} times that of the base", quantity(worst / self.base_peak))?;
            }
            writeln!(f, ", at {} per time", quantity(frequency))?;
        }
        let files: Vec<String> = self.files.iter().map(|file| format!("  wrote    {}", file.display())).collect();
        write!(f, "{}", files.join("\n"))
    }
}
