//! Ranges of frequencies that a command is asked for.

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
    /// At equal ratios; none where the lowest is not above 0, the range is empty, or the count is not 2 to `most`.
    pub(crate) fn by_ratios(&self, most: usize) -> Option<Vec<f64>> {
        let &Self { start, end, .. } = self;
        (start > 0.0).then(|| self.spaced(most, |part| start * (end / start).powf(part)))?
    }

    /// At equal distances; none where the lowest is below 0, the range is empty, or the count is not 2 to `most`.
    pub(crate) fn evenly(&self, most: usize) -> Option<Vec<f64>> {
        let &Self { start, end, .. } = self;
        (start >= 0.0).then(|| self.spaced(most, |part| start + (end - start) * part))?
    }

    /// By their parts of the range, from 0 to 1.
    fn spaced(&self, most: usize, at: impl Fn(f64) -> f64) -> Option<Vec<f64>> {
        let &Self { start, end, count } = self;
        if !(end > start && end.is_finite() && (2..=most).contains(&count)) {
            return None;
        }
        let last = (count - 1) as f64;
        let inner = (1..count - 1).map(|k| at(k as f64 / last));
        Some(std::iter::once(start).chain(inner).chain([end]).collect())
    }
}
