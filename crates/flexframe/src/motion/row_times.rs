//! Times of the rows of several bodies.

use scene::{Rows, Scene, StepControl};

/// Times closer than this part of the end are one.
const SAME: f64 = 1e-13;

/// The times at which several bodies have rows. They follow from the scene alone, not from the steps of a body.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RowTimes {
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
    /// The times that a scene asks for. Every N-th step is for a body whose loads have no discontinuities.
    pub fn new(scene: &Scene) -> Self {
        let end = scene.time.end;
        let spacing = match (scene.output.rows, scene.time.control) {
            (Rows::Interval(interval), _) => Spacing::Interval(interval),
            (Rows::EverySteps(every), StepControl::Fixed(step)) => {
                let count = (end / step * (1.0 - 1e-12)).ceil().max(1.0);
                Spacing::Steps(every, end / count)
            }
            // No scene has that.
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

    /// True if a body may be between two steps where there is a row.
    pub fn may_be_between_steps(&self) -> bool {
        matches!(self.spacing, Spacing::Steps(..))
    }

    /// True if two times are one but for rounding.
    pub fn are_same(&self, a: f64, b: f64) -> bool {
        (a - b).abs() <= SAME * self.end
    }
}
