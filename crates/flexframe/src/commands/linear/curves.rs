//! Files of answers over the frequency: a table for programs, a chart, and a page.

use std::path::{Path, PathBuf};

use diagnostic::Failure;
use figures::{LineChart, Scale, Series, Stroke};
use report::Responses;
use whole_file::write_whole;

use crate::files::write_error::WriteError;

/// Curves of a chart.
const MAX_CURVES: usize = 12;
/// Curves with a colour of their own: those after them are dashed.
const COLOURS: usize = 7;

/// An answer over the frequency.
pub(super) struct Answer {
    pub csv: String,
    pub chart: LineChart,
    pub page: Responses,
}

/// The files of an answer in a folder: `<name>.csv`, `<name>.html`, and `<name>` as SVG, PDF and PNG.
pub(super) fn files(folder: &Path, name: &str) -> Vec<PathBuf> {
    texts(folder, name).into_iter().chain(figures::files(&folder.join(name))).collect()
}

fn texts(folder: &Path, name: &str) -> [PathBuf; 2] {
    ["csv", "html"].map(|ending| folder.join(format!("{name}.{ending}")))
}

/// Writes the files of an answer.
pub(super) fn write(folder: &Path, name: &str, Answer { csv, chart, page }: Answer) -> Result<Vec<PathBuf>, Failure> {
    std::fs::create_dir_all(folder).map_err(WriteError::of(folder))?;
    let [table, html] = texts(folder, name);
    write_whole(&table, csv).map_err(WriteError::of(&table))?;
    page.write(&html)?;
    let pictures = chart.save(folder.join(name))?;
    Ok([table, html].into_iter().chain(pictures).collect())
}

/// Name and version of the program, as a page says them.
pub(super) fn program() -> String {
    format!("flexframe {}", env!("CARGO_PKG_VERSION"))
}

/// Curves of a chart with a logarithmic axis, while there is room: their points above zero, as the acceleration at no frequency is not.
/// Where there is none at all, the axis is linear and the curves are zero.
pub(super) fn with_positive(curves: Vec<(String, Vec<(f64, f64)>)>) -> (Scale, Vec<Series>) {
    let is_positive = |(_, y): &(f64, f64)| *y > 0.0;
    let scale = if curves.iter().flat_map(|(_, points)| points).any(is_positive) { Scale::Log } else { Scale::Linear };
    let mut series: Vec<Series> = Vec::new();
    for (label, mut points) in curves {
        points.retain(|point| scale == Scale::Linear || is_positive(point));
        if series.len() < MAX_CURVES && !points.is_empty() {
            let stroke = if series.len() < COLOURS { Stroke::Solid } else { Stroke::Dashed };
            series.push(Series { label, points, stroke });
        }
    }
    (scale, series)
}
