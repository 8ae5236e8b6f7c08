//! Histories given by rows of times and values.

use keys::{Key, Keyed};

use crate::error::SetupError;

/// Values at rising times, joined by straight lines; the first value holds before the first time, the last one after
/// the last.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(into = "(Vec<f64>, Vec<f64>)", try_from = "(Vec<f64>, Vec<f64>)")]
pub struct Table {
    times: Vec<f64>,
    values: Vec<f64>,
    discontinuities: Vec<f64>,
}

impl Table {
    /// A table of at least two rows.
    ///
    /// # Errors
    ///
    /// Lists of different lengths or of less than two entries, numbers that are not finite, times that do not rise.
    pub fn new(times: Vec<f64>, values: Vec<f64>) -> Result<Self, SetupError> {
        if times.len() < 2 {
            let what = "the list of times of a table";
            return Err(SetupError::Entries { what, found: times.len(), expected: "at least two".into() });
        }
        if values.len() != times.len() {
            let expected = format!("{}, one for each time", times.len());
            return Err(SetupError::Entries { what: "the list of values of a table", found: values.len(), expected });
        }
        for (what, list) in [("a time of a table", &times), ("a value of a table", &values)] {
            if let Some(found) = list.iter().copied().find(|x| !x.is_finite()) {
                return Err(SetupError::Value { what, found, expected: "a finite number" });
            }
        }
        if let Some(k) = times.windows(2).position(|pair| pair[0] >= pair[1]) {
            let what = "the list of times of a table";
            return Err(SetupError::NotRising { what, row: k + 2, found: times[k + 1], previous: times[k] });
        }
        let discontinuities = discontinuities(&times, &values);
        Ok(Self { times, values, discontinuities })
    }

    /// Times where the slope changes by more than the rounding of the rows.
    pub fn discontinuities(&self) -> &[f64] {
        &self.discontinuities
    }

    /// The value at a time, by the line that holds at `branch_time`.
    pub(super) fn at(&self, time: f64, branch_time: f64) -> f64 {
        let (row, slope) = self.line(time, branch_time);
        self.values[row] + slope * (time - self.times[row])
    }

    /// The slope at a time, of the line that holds at `branch_time`.
    pub(super) fn rate(&self, time: f64, branch_time: f64) -> f64 {
        self.line(time, branch_time).1
    }

    /// A row and the slope of the line through it that holds at a time.
    fn line(&self, time: f64, branch_time: f64) -> (usize, f64) {
        // Rows that lie on one line but for rounding are a smooth stretch, which a step may cross: within it the rows
        // next to the time count, and not those next to `branch_time`.
        let next = self.discontinuities.partition_point(|discontinuity| *discontinuity <= branch_time);
        let from = if next == 0 { f64::NEG_INFINITY } else { self.discontinuities[next - 1] };
        let to = self.discontinuities.get(next).copied().unwrap_or(f64::INFINITY);
        let within = if (from..=to).contains(&time) { time } else { branch_time };
        // Row after the time; at the ends of the stretch the one that belongs to its inner side.
        let row = if within >= to {
            self.times.partition_point(|t| *t < to)
        } else {
            self.times.partition_point(|t| *t <= within)
        };
        if row == 0 || row == self.times.len() {
            (row.saturating_sub(1), 0.0)
        } else {
            let (t, v) = (&self.times[row - 1..=row], &self.values[row - 1..=row]);
            (row - 1, (v[1] - v[0]) / (t[1] - t[0]))
        }
    }
}

/// Slope of a line through two rows, and its error by the rounding of both.
fn slope(t: &[f64], v: &[f64]) -> (f64, f64) {
    let dt = t[1] - t[0];
    let slope = (v[1] - v[0]) / dt;
    (slope, f64::EPSILON * (v[0].abs() + v[1].abs() + slope.abs() * (t[0].abs() + t[1].abs())) / dt)
}

fn discontinuities(times: &[f64], values: &[f64]) -> Vec<f64> {
    const FLAT: (f64, f64) = (0.0, 0.0);
    let lines = times.windows(2).zip(values.windows(2)).map(|(t, v)| slope(t, v));
    let mut discontinuities = Vec::new();
    let mut before = FLAT;
    for (time, after) in times.iter().zip(lines.chain([FLAT])) {
        if (after.0 - before.0).abs() > before.1 + after.1 {
            discontinuities.push(*time);
        }
        before = after;
    }
    discontinuities
}

impl From<Table> for (Vec<f64>, Vec<f64>) {
    fn from(Table { times, values, .. }: Table) -> Self {
        (times, values)
    }
}

impl TryFrom<(Vec<f64>, Vec<f64>)> for Table {
    type Error = SetupError;

    fn try_from((times, values): (Vec<f64>, Vec<f64>)) -> Result<Self, SetupError> {
        Self::new(times, values)
    }
}

impl Keyed for Table {
    fn key(&self, key: Key) -> Key {
        key.of("table", 1).with("times", &self.times).with("values", &self.values)
    }
}
