//! Files of answers over the frequency: a table for programs, and a chart.

use std::path::{Path, PathBuf};

use figures::{FigureError, LineChart, Series, Stroke};
use whole_file::write_whole;

use crate::files::write_error::WriteError;

/// Curves of a chart.
const MAX_CURVES: usize = 12;
/// Curves with a colour of their own: those after them are dashed.
const COLOURS: usize = 7;

/// The files of an answer in a folder: `<name>.csv`, and `<name>` as SVG, PDF and PNG.
pub(super) fn files(folder: &Path, name: &str) -> Vec<PathBuf> {
    std::iter::once(folder.join(format!("{name}.csv"))).chain(figures::files(&folder.join(name))).collect()
}

/// Writes the files of an answer.
pub(super) fn write<E: From<WriteError> + From<FigureError>>(
    folder: &Path,
    name: &str,
    csv: String,
    chart: &LineChart,
) -> Result<Vec<PathBuf>, E> {
    std::fs::create_dir_all(folder).map_err(WriteError::of(folder))?;
    let table = folder.join(format!("{name}.csv"));
    write_whole(&table, csv).map_err(WriteError::of(&table))?;
    let pictures = chart.save(folder.join(name))?;
    Ok(std::iter::once(table).chain(pictures).collect())
}

/// Adds a curve to those of a chart with a logarithmic axis while there is room, where it has a point above zero.
pub(super) fn add_curve(series: &mut Vec<Series>, label: String, points: Vec<(f64, f64)>) {
    if series.len() < MAX_CURVES && !points.is_empty() {
        let stroke = if series.len() < COLOURS { Stroke::Solid } else { Stroke::Dashed };
        series.push(Series { label, points, stroke });
    }
}
