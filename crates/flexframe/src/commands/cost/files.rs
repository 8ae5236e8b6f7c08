//! The price list as a table for programs, and as a diagram.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use diagnostic::Failure;
use figures::{FigureError, LineChart, Scale, Series, Stroke};
use whole_file::write_whole;

use super::ladder::{Line, Outcome};
use super::report::CostReport;
use super::setting::Setting;
use crate::files::write_error::WriteError;

const TABLE: &str = "cost.csv";
const DIAGRAM: &str = "work_precision";

/// The names of the columns of `cost.csv`.
const COLUMNS: [&str; 24] = [
    "formulation",
    "scheme",
    "step",
    "tolerance",
    "error",
    "at_reference",
    "attitude",
    "modal",
    "displacement",
    "velocity",
    "acceleration",
    "step_error",
    "energy",
    "angular_momentum",
    "spin",
    "step_spin",
    "steps",
    "rejected",
    "evaluations",
    "seconds",
    "spread",
    "repeats",
    "on_front",
    "failure",
];
/// Runs further off than this are not drawn.
const DRAWN: f64 = 1.0;

/// The files that [`price_list`](super::price_list) writes to a folder.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    std::iter::once(folder.join(TABLE)).chain(figures::files(&folder.join(DIAGRAM))).collect()
}

/// Writes `cost.csv`, and `work_precision` as SVG, PDF and PNG.
pub(super) fn write(report: &CostReport, folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    std::fs::create_dir_all(folder).map_err(WriteError::of(folder))?;
    let path = folder.join(TABLE);
    write_whole(&path, csv(report)).map_err(WriteError::of(&path))?;
    let mut files = vec![path];
    files.extend(draw(report, &folder.join(DIAGRAM))?);
    Ok(files)
}

fn csv(report: &CostReport) -> String {
    let mut csv = COLUMNS.join(",") + "\n";
    for line in &report.lines {
        for row in &line.rows {
            // Writing to a String cannot fail.
            let _ = write!(csv, "{},{}", line.formulation, line.scheme);
            let _ = match row.setting {
                Setting::Step(step) => write!(csv, ",{step:e},"),
                Setting::Tolerance(tolerance) => write!(csv, ",,{tolerance:e}"),
            };
            let _ = match &row.outcome {
                Outcome::Ran(m) => {
                    let e = &m.errors;
                    let number = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:e}"));
                    writeln!(
                        csv,
                        ",{:e},{},{:e},{},{},{},{},{},{:e},{:e},{},{},{},{},{},{:e},{:.3},{},{},",
                        m.error,
                        m.at_reference,
                        e.attitude,
                        number(e.modal),
                        number(e.displacement),
                        number(e.velocity),
                        number(e.acceleration),
                        number(m.step_errors.map(|errors| errors.largest())),
                        m.energy,
                        m.angular_momentum,
                        number(m.spin),
                        number(m.step_spin),
                        m.steps,
                        m.rejected,
                        m.evaluations,
                        m.seconds,
                        m.spread,
                        m.repeats,
                        row.on_front,
                    )
                }
                Outcome::Failed(failure) => write_failure(&mut csv, failure),
                Outcome::OutOfPatience(stopped) => write_failure(&mut csv, &stopped.to_string()),
            };
        }
    }
    csv
}

/// The columns after setting and scheme of a run that did not come to its end.
fn write_failure(csv: &mut String, why: &str) -> std::fmt::Result {
    let empty = ",".repeat(COLUMNS.len() - 5);
    writeln!(csv, "{empty},\"{}\"", why.replace('"', "\"\""))
}

/// Draws time against error, a line a scheme, to `<stem>.svg`, `<stem>.pdf` and `<stem>.png`; nothing where there is nothing to draw.
pub(super) fn draw(report: &CostReport, stem: &Path) -> Result<Vec<PathBuf>, FigureError> {
    let chart = LineChart {
        title: format!("{}: what accuracy costs", report.title),
        x_label: "largest error against the reference".to_owned(),
        y_label: "time of the run, s".to_owned(),
        x_scale: Scale::Log,
        y_scale: Scale::Log,
        // A scheme whose runs all failed stays in the list, so that the others have the same colours in every scene.
        series: report.lines.iter().map(series).collect(),
        reference: None,
    };
    if chart.is_empty() { Ok(Vec::new()) } else { Ok(chart.save(stem)?.to_vec()) }
}

fn series(line: &Line) -> Series {
    let slope = line.measured_order.map_or_else(String::new, |order| format!(": error ~ step^{order:.2}"));
    Series {
        label: format!("{}{slope}", line.name()),
        points: line
            .rows
            .iter()
            .filter_map(|row| row.measured())
            .filter(|measured| measured.error > 0.0 && measured.error <= DRAWN)
            .map(|measured| (measured.error, measured.seconds))
            .collect(),
        stroke: if line.controlled { Stroke::Dashed } else { Stroke::Solid },
    }
}
