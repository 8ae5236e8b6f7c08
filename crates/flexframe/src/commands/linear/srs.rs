//! `flexframe srs`: shock response spectra of a base motion, Eqs. (R1) and (R2) of `docs/method/shock.md`.

pub(super) mod table;

use std::f64::consts::TAU;
use std::path::Path;

use diagnostic::{Diagnostic, Failure, Kind};
use report::{Chart, Curve, Curves, File, Form, Report, Table, Value, quantity};
pub use scene::Interpolation;
use shock::{Peaks, Spectrum};

use crate::commands::linear::frequencies::Frequencies;

/// The files of [`srs`]: `srs.csv`, the page `srs.html`, and `srs` as SVG, PDF and PNG.
pub const FILES: [File; 3] = [File::Table("srs"), File::Page("srs"), File::Chart("srs")];
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

/// Computes the spectra of the base motion in a CSV file.
///
/// # Errors
/// [`Failure`].
pub fn srs(table: &Path, settings: &SrsSettings) -> Result<Report, Failure> {
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

    let name = table.file_stem().unwrap_or(table.as_os_str()).to_string_lossy();
    let between = settings.interpolation.words();
    let mut report = Report::new(&name);
    report.say("table", "table", table.display().to_string());
    report.put("interpolation", Value::of(&settings.interpolation));
    report.put("duration", motion.duration());
    report.put("base_peak", motion.peak());
    let [duration, peak] = [motion.duration(), motion.peak()].map(quantity);
    report.line(
        "base",
        format!("{duration} long, peak acceleration {peak}, {between} between rows, zero after the last"),
    );
    report.put("frequencies", &frequencies[..]);
    let ratio = |of: &Spectrum| of.damping_ratio;
    let list =
        |value: fn(&Peaks) -> f64| spectra.iter().map(move |of| of.peaks.iter().map(value).collect::<Vec<f64>>());
    let worst = || spectra.iter().map(|of| worst(&of.peaks));
    report.table(
        Table::new("spectra", "spectra")
            .titled("largest acceleration of the mass")
            .shown("damping_ratio", "ζ", Form::Plain, spectra.iter().map(ratio))
            .column("displacement", list(|peaks| peaks.displacement))
            .column("acceleration_largest", list(|peaks| peaks.acceleration_largest))
            .column("acceleration_least", list(|peaks| peaks.acceleration_least))
            .text_only("acceleration", Form::Plain, worst().map(|(_, most)| most))
            .text_only(
                "over the base's",
                Form::Plain,
                worst().map(|(_, most)| Some(most / motion.peak()).filter(|part| part.is_finite())),
            )
            .text_only("at, 1/time", Form::Plain, worst().map(|(at, _)| frequencies[at])),
    );

    let mut rows = Table::new("srs", None).column("frequency", frequencies.iter().copied());
    for Spectrum { damping_ratio, peaks, .. } in &spectra {
        let pseudo = |power: i32| {
            frequencies
                .iter()
                .zip(peaks)
                .map(move |(frequency, peaks)| (TAU * frequency).powi(power) * peaks.displacement)
        };
        rows = rows
            .column(format!("displacement_{damping_ratio}"), pseudo(0))
            .column(format!("pseudo_velocity_{damping_ratio}"), pseudo(1))
            .column(format!("pseudo_acceleration_{damping_ratio}"), pseudo(2))
            .column(format!("acceleration_largest_{damping_ratio}"), peaks.iter().map(|of| of.acceleration_largest))
            .column(format!("acceleration_least_{damping_ratio}"), peaks.iter().map(|of| of.acceleration_least));
    }
    report.csv_tables.push(rows);
    let curve = |of: &Spectrum| Curve {
        name: format!("ζ = {}", of.damping_ratio),
        // The table has no units.
        units: vec![String::new(); 2],
        values: vec![
            of.peaks.iter().map(Peaks::acceleration).collect(),
            of.peaks.iter().map(|peaks| peaks.displacement).collect(),
        ],
        about: Vec::new(),
    };
    report.curves = Some(Curves {
        subject: "shock response spectrum",
        curves: spectra.iter().map(curve).collect(),
        frequency_unit: "1/time".to_owned(),
        logarithmic: true,
        charts: vec![
            Chart::new("Largest acceleration of the mass (unit of the table)", true),
            Chart::new("Displacement from the base", true),
        ],
        headings: Vec::new(),
        resonances: Vec::new(),
        frequencies,
    });
    Ok(report)
}

/// The largest magnitude of the acceleration of the mass, and the place of its frequency.
fn worst(peaks: &[Peaks]) -> (usize, f64) {
    let magnitudes = peaks.iter().map(Peaks::acceleration).enumerate();
    magnitudes.fold((0, 0.0), |most, here| if here.1 > most.1 { here } else { most })
}
