//! Densities as a table for programs, and as a chart.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use figures::{LineChart, Scale, Series, Stroke};
use whole_file::write_whole;

use super::error::PsdError;
use super::responses::Responses;
use crate::commands::modes::frequency_unit;
use crate::files::write_error::WriteError;

const TABLE: &str = "psd.csv";
const CHART: &str = "psd";
/// Curves of a chart.
const MAX_CURVES: usize = 12;

/// The files that [`psd`](super::psd) writes to a folder.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    std::iter::once(folder.join(TABLE)).chain(figures::files(&folder.join(CHART))).collect()
}

pub(super) fn write(
    title: &str,
    time_unit: &str,
    responses: &Responses,
    folder: &Path,
) -> Result<Vec<PathBuf>, PsdError> {
    std::fs::create_dir_all(folder).map_err(WriteError::of(folder))?;
    let table = folder.join(TABLE);
    write_whole(&table, csv(responses)).map_err(WriteError::of(&table))?;
    let mut files = vec![table];
    files.extend(chart(title, &frequency_unit(time_unit), responses).save(folder.join(CHART))?);
    Ok(files)
}

/// A row a frequency: the density of each output, unit² per cycle per time.
fn csv(responses: &Responses) -> String {
    let mut csv = "frequency".to_owned();
    for (channel, _) in &responses.outputs {
        // Writing to a String cannot fail.
        let _ = write!(csv, ",{}", channel.name);
    }
    csv.push('\n');
    for (k, frequency) in responses.frequencies.iter().enumerate() {
        let _ = write!(csv, "{frequency:e}");
        for (_, response) in &responses.outputs {
            let _ = write!(csv, ",{:e}", response.density[k]);
        }
        csv.push('\n');
    }
    csv
}

fn chart(title: &str, unit: &str, responses: &Responses) -> LineChart {
    let mut series = Vec::new();
    for (channel, response) in &responses.outputs {
        let points: Vec<(f64, f64)> = responses
            .frequencies
            .iter()
            .copied()
            .zip(response.density.iter().copied())
            .filter(|(_, y)| *y > 0.0)
            .collect();
        // An output that sees nothing has no place on a logarithmic axis.
        if series.len() < MAX_CURVES && !points.is_empty() {
            let stroke = if series.len() < 7 { Stroke::Solid } else { Stroke::Dashed };
            series.push(Series { label: channel.name.clone(), points, stroke });
        }
    }
    LineChart {
        title: format!("{title}: power spectral density"),
        x_label: format!("Frequency ({unit})"),
        y_label: format!("Unit² per {unit}"),
        x_scale: Scale::Log,
        y_scale: Scale::Log,
        series,
        reference: None,
    }
}
