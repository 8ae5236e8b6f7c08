//! Times of the rows of several islands.

use crate::simulation::plan::{Rows, StepControl};

/// Times closer than this part of the end are one.
const SAME: f64 = 1e-13;

/// The times at which several islands have rows. They do not follow from the steps of an island.
#[derive(Debug, Clone, Copy)]
pub struct RowTimes {
    spacing: Spacing,
    end: f64,
}

#[derive(Debug, Clone, Copy)]
enum Spacing {
    /// Multiples of a time.
    Interval(f64),
    /// Every N-th of equal steps of this length.
    Steps(u64, f64),
}

impl RowTimes {
    /// The times of rows up to an end. Every N-th step is for bodies whose loads have no discontinuities.
    pub fn new(rows: Rows, control: StepControl, end: f64) -> Self {
        let spacing = match (rows, control) {
            (Rows::Interval(interval), _) => Spacing::Interval(interval),
            (Rows::EverySteps(every), StepControl::Fixed(step)) => {
                let count = (end / step * (1.0 - 1e-12)).ceil().max(1.0);
                Spacing::Steps(every, end / count)
            }
            // One row, at the end.
            (Rows::EverySteps(_), StepControl::Tolerance(_)) => Spacing::Interval(end),
        };
        Self { spacing, end }
    }

    /// Time of a row, by its number from 0.
    pub fn of(&self, row: u64) -> f64 {
        let time = match self.spacing {
            Spacing::Interval(interval) => row as f64 * interval,
            Spacing::Steps(every, step) => row.saturating_mul(every) as f64 * step,
        };
        if self.are_same(time, self.end) { self.end } else { time.min(self.end) }
    }

    /// Number of rows.
    pub fn count(&self) -> u64 {
        let spacing = match self.spacing {
            Spacing::Interval(interval) => interval,
            Spacing::Steps(every, step) => every as f64 * step,
        };
        ((self.end / spacing * (1.0 - 1e-12)).ceil() as u64).saturating_add(1)
    }

    /// The rows of bodies in joints, whose steps do not end at them.
    pub fn of_systems(&self) -> Rows {
        let first = self.of(1);
        if first < self.end { Rows::Interval(first) } else { Rows::EverySteps(u64::MAX) }
    }

    /// True if a body may be between two steps where there is a row.
    pub(crate) fn may_be_between_steps(&self) -> bool {
        matches!(self.spacing, Spacing::Steps(..))
    }

    /// True if two times are one but for rounding.
    pub(crate) fn are_same(&self, a: f64, b: f64) -> bool {
        (a - b).abs() <= SAME * self.end
    }
}
