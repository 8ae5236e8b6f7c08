//! Histories given by rows of times and values.

mod pieces;

use keys::{Key, Keyed};

use crate::error::SetupError;
use pieces::{discontinuities, monotone_rates};

/// Values at rising times, joined by straight lines or by cubics; the first value holds before the first time, the last one after
/// the last.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(into = "(Vec<f64>, Vec<f64>)", try_from = "(Vec<f64>, Vec<f64>)")]
pub struct Table {
    times: Vec<f64>,
    values: Vec<f64>,
    /// Rates at the rows, of cubics; none of straight lines.
    rates: Vec<f64>,
    discontinuities: Vec<f64>,
}

impl Table {
    /// A table of at least two rows, joined by straight lines.
    ///
    /// # Errors
    ///
    /// Lists of different lengths or of less than two entries, numbers that are not finite, times that do not rise.
    pub fn new(times: Vec<f64>, values: Vec<f64>) -> Result<Self, SetupError> {
        Self::with_rates(times, values, Vec::new())
    }

    /// A table of at least two rows, joined by cubics whose rates do not jump, and which rise and fall only where the rows do
    /// (Fritsch and Carlson 1980, with the rates of Fritsch and Butland 1984).
    ///
    /// # Errors
    ///
    /// As [`Self::new`].
    pub fn monotone_cubic(times: Vec<f64>, values: Vec<f64>) -> Result<Self, SetupError> {
        let Self { times, values, .. } = Self::new(times, values)?;
        let rates = monotone_rates(&times, &values);
        Self::with_rates(times, values, rates)
    }

    fn with_rates(times: Vec<f64>, values: Vec<f64>, rates: Vec<f64>) -> Result<Self, SetupError> {
        if times.len() < 2 {
            let what = "the list of times of a table";
            return Err(SetupError::Entries { what, found: times.len(), expected: "at least two".into() });
        }
        if values.len() != times.len() {
            let expected = format!("{}, one for each time", times.len());
            return Err(SetupError::Entries { what: "the list of values of a table", found: values.len(), expected });
        }
        for (what, list) in
            [("a time of a table", &times), ("a value of a table", &values), ("a rate of a table", &rates)]
        {
            if let Some(found) = list.iter().copied().find(|x| !x.is_finite()) {
                return Err(SetupError::Value { what, found, expected: "a finite number" });
            }
        }
        if let Some(k) = times.windows(2).position(|pair| pair[0] >= pair[1]) {
            let what = "the list of times of a table";
            return Err(SetupError::NotRising { what, row: k + 2, found: times[k + 1], previous: times[k] });
        }
        let discontinuities = discontinuities(&times, &values, &rates);
        Ok(Self { times, values, rates, discontinuities })
    }

    /// Rates at the rows, of cubics; none of straight lines.
    pub fn rates(&self) -> &[f64] {
        &self.rates
    }

    /// Times where a rate changes by more than the rounding of the rows: the rate of straight lines, or any rate of cubics.
    pub fn discontinuities(&self) -> &[f64] {
        &self.discontinuities
    }

    /// The value at a time, by the piece that holds at `branch_time`.
    pub(super) fn at(&self, time: f64, branch_time: f64) -> f64 {
        self.value_and_rate(time, branch_time)[0]
    }

    /// The rate at a time, of the piece that holds at `branch_time`.
    pub(super) fn rate(&self, time: f64, branch_time: f64) -> f64 {
        self.value_and_rate(time, branch_time)[1]
    }

    /// The value and the rate at a time, of the piece that holds at another.
    fn value_and_rate(&self, time: f64, branch_time: f64) -> [f64; 2] {
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
            return [self.values[row.saturating_sub(1)], 0.0];
        }
        let (t, v) = (&self.times[row - 1..=row], &self.values[row - 1..=row]);
        let (length, from_row) = (t[1] - t[0], time - t[0]);
        let slope = (v[1] - v[0]) / length;
        let Some(rates) = self.rates.get(row - 1..=row) else { return [v[0] + slope * from_row, slope] };
        // v₀ + x (s + (1 − y)((1 − y)(r₀ − s) − y (r₁ − s))) with y = x/length: the line, and what the rates add.
        let y = from_row / length;
        let [before, after] = [rates[0] - slope, rates[1] - slope];
        let value = v[0] + from_row * (slope + (1.0 - y) * ((1.0 - y) * before - y * after));
        let rate = slope + (1.0 - y) * (1.0 - 3.0 * y) * before + y * (3.0 * y - 2.0) * after;
        [value, rate]
    }
}

impl From<Table> for (Vec<f64>, Vec<f64>) {
    /// Rates stand after the values.
    fn from(Table { times, mut values, rates, .. }: Table) -> Self {
        values.extend(rates);
        (times, values)
    }
}

impl TryFrom<(Vec<f64>, Vec<f64>)> for Table {
    type Error = SetupError;

    fn try_from((times, mut values): (Vec<f64>, Vec<f64>)) -> Result<Self, SetupError> {
        let has_rates = times.len() >= 2 && values.len() == 2 * times.len();
        let rates = if has_rates { values.split_off(times.len()) } else { Vec::new() };
        Self::with_rates(times, values, rates)
    }
}

impl Keyed for Table {
    fn key(&self, key: Key) -> Key {
        let key = key.of("table", 1).with("times", &self.times).with("values", &self.values);
        if self.rates.is_empty() { key } else { key.with("rates", &self.rates) }
    }
}
