//! The branches and the critical speeds as tables for programs, and as a diagram.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use diagnostic::Failure;
use whole_file::write_whole;

use super::critical::Critical;
use super::diagram::draw;
use super::report::CampbellReport;
use crate::files::write_error::WriteError;

const BRANCHES: &str = "campbell.csv";
const CRITICAL_SPEEDS: &str = "critical_speeds.csv";
const DIAGRAM: &str = "campbell";

/// The files that [`campbell`](super::campbell) writes to a folder.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let tables = [BRANCHES, CRITICAL_SPEEDS].map(|name| folder.join(name));
    tables.into_iter().chain(figures::files(&folder.join(DIAGRAM))).collect()
}

/// Writes `campbell.csv`, `critical_speeds.csv`, and `campbell` as SVG, PDF and PNG.
pub(super) fn write(report: &CampbellReport, folder: &Path, orders: &[f64]) -> Result<Vec<PathBuf>, Failure> {
    std::fs::create_dir_all(folder).map_err(WriteError::of(folder))?;
    let mut files = Vec::new();
    for (name, text) in [(BRANCHES, branches(report)), (CRITICAL_SPEEDS, critical_speeds(report))] {
        let path = folder.join(name);
        write_whole(&path, text).map_err(WriteError::of(&path))?;
        files.push(path);
    }
    files.extend(draw(report, orders, &folder.join(DIAGRAM))?);
    Ok(files)
}

/// A row a speed: the frequencies of all modes, then their growth, then their whirl, and the deflection of a body that is bent.
fn branches(report: &CampbellReport) -> String {
    let mut csv = "speed".to_owned();
    for quantity in ["frequency", "growth", "whirl"] {
        for branch in &report.branches {
            // Writing to a String cannot fail.
            let _ = write!(csv, ",{quantity}_{}", branch.mode);
        }
    }
    let deflection = if report.deflection.is_empty() { "" } else { ",deflection" };
    csv.push_str(deflection);
    csv.push('\n');
    for (i, speed) in report.speeds.iter().enumerate() {
        let _ = write!(csv, "{speed:e}");
        let frequencies = report.branches.iter().map(|branch| branch.frequency[i]);
        let growths = report.branches.iter().map(|branch| branch.growth[i]);
        let whirls = report.branches.iter().map(|branch| branch.whirl[i]);
        for value in frequencies.chain(growths).chain(whirls) {
            let _ = write!(csv, ",{value:e}");
        }
        if let Some(deflection) = report.deflection.get(i) {
            let _ = write!(csv, ",{deflection:e}");
        }
        csv.push('\n');
    }
    csv
}

fn critical_speeds(report: &CampbellReport) -> String {
    let mut csv = "order,mode,speed,frequency,kind\n".to_owned();
    for &Critical { kind, order, mode, speed, frequency } in &report.critical_speeds {
        let _ = writeln!(csv, "{order},{mode},{speed:e},{frequency:e},{}", kind.name());
    }
    csv
}
