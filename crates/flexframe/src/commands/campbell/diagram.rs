//! The diagram: branches, engine orders and where they cross.

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

use figures::{FigureError, LineChart, Scale, Series, Stroke};

use super::report::CampbellReport;

/// Colours that a chart has before they begin again.
const COLOURS: usize = 7;
/// More branches than this cannot be told apart.
const MAX_BRANCHES: usize = 2 * COLOURS;
/// The diagram reaches this far above the highest order,
const ABOVE_ORDERS: f64 = 1.15;
/// but at most so far above the highest branch.
const ABOVE_BRANCHES: f64 = 1.05;

/// Draws `<stem>.svg`, `<stem>.pdf` and `<stem>.png`. Branches far above every order are left out.
pub(super) fn draw(report: &CampbellReport, orders: &[f64], stem: &Path) -> Result<[PathBuf; 3], FigureError> {
    let end = report.speeds.last().copied().unwrap_or_default();
    let highest_order = orders.iter().copied().fold(0.0, f64::max);
    let top = top(report, highest_order * end / TAU);
    let mut series: Vec<Series> = Vec::new();
    for branch in report.branches.iter().filter(|branch| branch.frequency.iter().any(|f| *f <= top)) {
        if series.len() == MAX_BRANCHES {
            break;
        }
        let points = report.speeds.iter().copied().zip(branch.frequency.iter().copied()).collect();
        series.push(Series {
            label: branch.label(),
            points,
            stroke: if series.len() < COLOURS { Stroke::Solid } else { Stroke::Dashed },
        });
    }
    let start = report.speeds.first().copied().unwrap_or_default();
    for order in orders {
        let line = [(start, order * start / TAU), (end, order * end / TAU)];
        series.push(Series { label: format!("{order}×"), points: line.to_vec(), stroke: Stroke::Guide });
    }
    let points: Vec<(f64, f64)> = report.critical_speeds.iter().map(|c| (c.speed, c.frequency)).collect();
    if !points.is_empty() {
        series.push(Series { label: "critical speed".to_owned(), points, stroke: Stroke::Rings });
    }
    let axis = report.axis.map(|x| format!("{}", (1e4 * x).round() / 1e4).replace('-', "−")).join(", ");
    LineChart {
        title: format!("{}: natural frequencies in spin about ({axis})", report.title),
        x_label: format!("Spin speed Ω (rad/{})", report.time_unit),
        y_label: format!("Frequency ({})", report.frequency_unit),
        x_scale: Scale::Linear,
        y_scale: Scale::Window(0.0, top),
        series,
        reference: None,
    }
    .save(stem)
}

/// The highest frequency drawn: above all orders and the lowest branch, but not far above all branches.
fn top(report: &CampbellReport, highest_order: f64) -> f64 {
    let most = |frequency: &[f64]| frequency.iter().copied().fold(0.0, f64::max);
    let lowest = report.branches.iter().map(|branch| most(&branch.frequency)).fold(f64::INFINITY, f64::min);
    let highest = report.branches.iter().map(|branch| most(&branch.frequency)).fold(0.0, f64::max);
    (ABOVE_ORDERS * highest_order.max(lowest)).min(ABOVE_BRANCHES * highest)
}
