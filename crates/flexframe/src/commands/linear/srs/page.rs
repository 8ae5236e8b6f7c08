//! The page of spectra: the largest acceleration of the mass, and its displacement from the base.

use std::path::Path;

use report::{Chart, Curve, Fact, Responses};
use scene::Interpolation;
use shock::Spectrum;

use crate::commands::linear::curves::program;

/// The page of some spectra of a table.
pub(super) fn page(table: &Path, interpolation: Interpolation, spectra: &[Spectrum]) -> Responses {
    let curve = |spectrum: &Spectrum| {
        let of = |value: fn(&shock::Peaks) -> f64| spectrum.peaks.iter().map(value).collect::<Vec<f64>>();
        Curve {
            name: format!("ζ = {}", spectrum.damping_ratio),
            // The table has no units.
            units: vec![String::new(); 2],
            values: vec![of(shock::Peaks::acceleration), of(|peaks| peaks.displacement)],
            about: Vec::new(),
        }
    };
    let name = table.file_stem().unwrap_or(table.as_os_str()).to_string_lossy();
    Responses {
        title: format!("{name}: shock response spectrum"),
        program: program(),
        facts: vec![
            Fact::new("Base motion", table.display().to_string()),
            Fact::new("Between its rows", interpolation.words()),
        ],
        warnings: Vec::new(),
        frequency_unit: "1/time".to_owned(),
        logarithmic: true,
        frequencies: spectra.first().map_or_else(Vec::new, |spectrum| spectrum.frequencies.clone()),
        charts: vec![
            Chart { name: "Acceleration of the mass".to_owned(), logarithmic: true },
            Chart { name: "Displacement from the base".to_owned(), logarithmic: true },
        ],
        headings: Vec::new(),
        curves: spectra.iter().map(curve).collect(),
    }
}
