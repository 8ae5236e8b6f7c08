//! Which rows of a results file are exported.

use std::path::Path;

use results::Results;

use super::error::ExportError;

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

impl ExportRows {
    /// Their numbers, one at least.
    pub(super) fn of(&self, file: &Path, results: &Results) -> Result<Vec<usize>, ExportError> {
        let times = results.numbers("time").unwrap_or_default();
        // Times of rows are sums of steps.
        let slack = 1e-9 * times.last().copied().unwrap_or_default().abs();
        let from = self.from.map_or(f64::NEG_INFINITY, |from| from - slack);
        let to = self.to.map_or(f64::INFINITY, |to| to + slack);
        let within = (0..times.len()).filter(|row| (from..=to).contains(&times[*row]));
        let chosen: Vec<usize> = within.step_by(self.every.max(1)).collect();
        if chosen.is_empty() {
            let times = [times.first(), times.last()].map(|time| time.copied().unwrap_or_default());
            return Err(ExportError::NoRows { path: file.to_owned(), times });
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
