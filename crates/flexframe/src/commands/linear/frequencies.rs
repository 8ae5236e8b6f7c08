//! Ranges of frequencies that a command is asked for.

use diagnostic::{Failure, Kind};

/// Frequencies, both ends included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frequencies {
    /// The lowest, cycles per time.
    pub start: f64,
    /// The highest.
    pub end: f64,
    /// Their number.
    pub count: usize,
}

impl Frequencies {
    /// At equal ratios; refused where the lowest is not above 0, the range is empty, or the count is not 2 to `most`.
    pub(crate) fn by_ratios(&self, most: usize) -> Result<Vec<f64>, Failure> {
        let &Self { start, end, .. } = self;
        if start > 0.0 {
            self.spaced(most, |part| start * (end / start).powf(part))
        } else {
            Err(self.refusal("<", most))
        }
    }

    /// At equal distances; refused where the lowest is below 0, the range is empty, or the count is not 2 to `most`.
    pub(crate) fn evenly(&self, most: usize) -> Result<Vec<f64>, Failure> {
        let &Self { start, end, .. } = self;
        if start >= 0.0 {
            self.spaced(most, |part| start + (end - start) * part)
        } else {
            Err(self.refusal("≤", most))
        }
    }

    fn refusal(&self, below: &str, most: usize) -> Failure {
        let Self { start, end, count } = self;
        let expected =
            format!("start:end:count, cycles per time, with 0 {below} start < end and a count of 2 to {most}");
        let wrong = Kind::Usage.alone().key("frequencies").found(format!("{start}:{end}:{count}")).expected(expected);
        wrong.help("give a range, such as 1:2000:200").into()
    }

    /// By their parts of the range, from 0 to 1.
    fn spaced(&self, most: usize, at: impl Fn(f64) -> f64) -> Result<Vec<f64>, Failure> {
        let &Self { start, end, count } = self;
        if !(end > start && end.is_finite() && (2..=most).contains(&count)) {
            return Err(self.refusal("≤", most));
        }
        let last = (count - 1) as f64;
        let inner = (1..count - 1).map(|k| at(k as f64 / last));
        Ok(std::iter::once(start).chain(inner).chain([end]).collect())
    }
}
