//! The spectra as a table for programs, as a diagram and as a page.

use std::f64::consts::TAU;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use diagnostic::Failure;
use scene::Interpolation;
use shock::Spectrum;

use super::diagram::diagram;
use super::page::page;
use crate::commands::linear::curves::{self, Answer};

const NAME: &str = "srs";

/// The files that [`srs`](super::srs) writes to a folder.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    curves::files(folder, NAME)
}

/// Writes `srs.csv`, `srs.html`, and `srs` as SVG, PDF and PNG.
pub(super) fn write(
    (table, interpolation): (&Path, Interpolation),
    spectra: &[Spectrum],
    folder: &Path,
) -> Result<Vec<PathBuf>, Failure> {
    let (chart, page) = (diagram(table, spectra), page(table, interpolation, spectra));
    curves::write(folder, NAME, Answer { csv: rows(spectra), chart, page })
}

/// A row a frequency: for each damping ratio the quantities of a spectrum.
fn rows(spectra: &[Spectrum]) -> String {
    let mut csv = "frequency".to_owned();
    for Spectrum { damping_ratio, .. } in spectra {
        for quantity in
            ["displacement", "pseudo_velocity", "pseudo_acceleration", "acceleration_largest", "acceleration_least"]
        {
            // Writing to a String cannot fail.
            let _ = write!(csv, ",{quantity}_{damping_ratio}");
        }
    }
    csv.push('\n');
    let frequencies = spectra.first().map_or(&[][..], |spectrum| &spectrum.frequencies);
    for (k, frequency) in frequencies.iter().enumerate() {
        let omega = TAU * frequency;
        let _ = write!(csv, "{frequency:e}");
        for peaks in spectra.iter().map(|spectrum| &spectrum.peaks[k]) {
            let z = peaks.displacement;
            let (largest, least) = (peaks.acceleration_largest, peaks.acceleration_least);
            let _ = write!(csv, ",{z:e},{:e},{:e},{largest:e},{least:e}", omega * z, omega * omega * z);
        }
        csv.push('\n');
    }
    csv
}
