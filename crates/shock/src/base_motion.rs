//! The acceleration of a base as a table.

use crate::error::ShockError;

/// The acceleration of a base: straight between rows, zero after the last.
#[derive(Debug, Clone, PartialEq)]
pub struct BaseMotion {
    times: Vec<f64>,
    accelerations: Vec<f64>,
}

impl BaseMotion {
    /// With rising times and the acceleration at each.
    ///
    /// # Errors
    /// [`ShockError::Rows`], [`ShockError::Row`].
    pub fn new(times: Vec<f64>, accelerations: Vec<f64>) -> Result<Self, ShockError> {
        if times.len() != accelerations.len() || times.len() < 2 {
            return Err(ShockError::Rows { times: times.len(), accelerations: accelerations.len() });
        }
        for (list, what) in [(&times, "the time"), (&accelerations, "the acceleration")] {
            if let Some((k, found)) = list.iter().enumerate().find(|(_, x)| !x.is_finite()) {
                return Err(ShockError::Row { what, row: k + 1, found: *found, expected: "a finite number" });
            }
        }
        if let Some(k) = (1..times.len()).find(|k| times[*k] <= times[k - 1]) {
            let expected = "more than in the row before";
            return Err(ShockError::Row { what: "the time", row: k + 1, found: times[k], expected });
        }
        Ok(Self { times, accelerations })
    }

    /// Time from the first row to the last.
    pub fn duration(&self) -> f64 {
        self.times[self.times.len() - 1] - self.times[0]
    }

    /// The largest magnitude of the acceleration.
    pub fn peak(&self) -> f64 {
        self.accelerations.iter().fold(0.0, |most, a| a.abs().max(most))
    }

    /// Duration, and acceleration at the beginning and at the end, of each piece.
    pub(crate) fn pieces(&self) -> impl Iterator<Item = (f64, [f64; 2])> {
        let durations = self.times.windows(2).map(|t| t[1] - t[0]);
        durations.zip(self.accelerations.windows(2).map(|a| [a[0], a[1]]))
    }
}
