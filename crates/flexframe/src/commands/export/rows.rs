//! Which rows of a results file are exported.

use std::path::Path;

use diagnostic::{Failure, Kind};
use results::Results;

/// Every N-th row from one time to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExportRows {
    /// First time; that of the first row if not given.
    pub from: Option<f64>,
    /// Last time; that of the last row if not given.
    pub to: Option<f64>,
    /// N: every N-th row is written, from the first on.
    pub every: usize,
    /// True if a file that is there is replaced.
    pub overwrite: bool,
}

impl Default for ExportRows {
    /// All of them, and nothing is replaced.
    fn default() -> Self {
        Self { from: None, to: None, every: 1, overwrite: false }
    }
}

/// The refusal of times that no row is within; `times` are of the first and the last row.
pub(crate) fn no_rows(file: &Path, [first, last]: [f64; 2]) -> Failure {
    let help = "give --from and --to within them, or leave them out";
    let words = format!("no row is within the times asked for; its rows are from time {first} to {last}");
    Kind::Usage.of(file).help(help).says(words)
}

/// The refusal of a body that has nodes, but no elements.
pub(crate) fn no_elements(file: &Path) -> Failure {
    let help = "export a table, --csv TABLE.csv, or give the body a mesh";
    let words = "no elements to show: a body of matrices has none, nor a surface, and a rigid body without a mesh has a surface alone";
    Kind::Input.of(file).help(help).says(words)
}

impl ExportRows {
    /// Their numbers, one at least.
    pub(super) fn of(&self, file: &Path, results: &Results) -> Result<Vec<usize>, Failure> {
        let times = results.numbers("time").unwrap_or_default();
        // Times of rows are sums of steps.
        let slack = 1e-9 * times.last().copied().unwrap_or_default().abs();
        let from = self.from.map_or(f64::NEG_INFINITY, |from| from - slack);
        let to = self.to.map_or(f64::INFINITY, |to| to + slack);
        let within = (0..times.len()).filter(|row| (from..=to).contains(&times[*row]));
        let chosen: Vec<usize> = within.step_by(self.every.max(1)).collect();
        if chosen.is_empty() {
            let times = [times.first(), times.last()].map(|time| time.copied().unwrap_or_default());
            return Err(no_rows(file, times));
        }
        Ok(chosen)
    }

    /// Warning about an export of these results.
    pub(super) fn warning(results: &Results) -> Option<String> {
        let last = results.numbers("time").and_then(|times| times.last()).copied().unwrap_or_default();
        let unchecked =
            results.unchecked_from.map(|time| format!(", and from time {time} on no check sum covers them"));
        let unchecked = unchecked.unwrap_or_default();
        (!results.complete).then(|| format!("the run is unfinished: its rows end at time {last}{unchecked}"))
    }
}
