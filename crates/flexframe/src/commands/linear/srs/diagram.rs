//! The diagram: the largest acceleration of the mass against its frequency.

use std::path::Path;

use figures::{LineChart, Scale, Series, Stroke};
use shock::Spectrum;

/// The diagram of some spectra of a table.
pub(super) fn diagram(table: &Path, spectra: &[Spectrum]) -> LineChart {
    let line = |spectrum: &Spectrum| {
        let points = spectrum.frequencies.iter().copied();
        let points = points.zip(spectrum.peaks.iter().map(shock::Peaks::acceleration));
        Series {
            label: format!("ζ = {}", spectrum.damping_ratio),
            // A logarithm needs what is positive; a base that does not move has none.
            points: points.filter(|(_, acceleration)| *acceleration > 0.0).collect(),
            stroke: Stroke::Solid,
        }
    };
    let name = table.file_stem().unwrap_or(table.as_os_str()).to_string_lossy();
    LineChart {
        title: format!("{name}: shock response spectrum"),
        x_label: "Frequency (1/time)".to_owned(),
        y_label: "Largest acceleration of the mass (unit of the table)".to_owned(),
        x_scale: Scale::Log,
        y_scale: Scale::Log,
        series: spectra.iter().map(line).collect(),
        reference: None,
    }
}
