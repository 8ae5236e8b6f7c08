//! The acceleration of a base as a table.

use crate::error::ShockError;

/// The acceleration of a base: straight or cubic between rows, zero after the last.
#[derive(Debug, Clone, PartialEq)]
pub struct BaseMotion {
    times: Vec<f64>,
    accelerations: Vec<f64>,
    /// Rates at the rows, of cubics; none of straight lines.
    rates: Vec<f64>,
}

/// The acceleration between two rows.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Piece {
    pub duration: f64,
    pub ends: [f64; 2],
    /// Changes over the piece by the rates at its ends, of a cubic.
    pub slopes: Option<[f64; 2]>,
}

impl Piece {
    /// The acceleration where a part of the piece is over.
    pub fn at(&self, part: f64) -> f64 {
        let [from, to] = self.ends;
        let straight = from + (to - from) * part;
        let Some([of_from, of_to]) = self.slopes else { return straight };
        let left = 1.0 - part;
        straight + part * left * (left * (of_from - (to - from)) - part * (of_to - (to - from)))
    }
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
        Ok(Self { times, accelerations, rates: Vec::new() })
    }

    /// With cubics between the rows, by the rate at each.
    ///
    /// # Errors
    /// [`ShockError::Rates`], [`ShockError::Row`].
    pub fn with_rates(self, rates: Vec<f64>) -> Result<Self, ShockError> {
        if rates.len() != self.times.len() {
            return Err(ShockError::Rates { times: self.times.len(), rates: rates.len() });
        }
        if let Some((k, found)) = rates.iter().enumerate().find(|(_, x)| !x.is_finite()) {
            return Err(ShockError::Row { what: "the rate", row: k + 1, found: *found, expected: "a finite number" });
        }
        Ok(Self { rates, ..self })
    }

    /// Time from the first row to the last.
    pub fn duration(&self) -> f64 {
        self.times[self.times.len() - 1] - self.times[0]
    }

    /// The largest magnitude of the acceleration.
    pub fn peak(&self) -> f64 {
        self.accelerations.iter().fold(0.0, |most, a| a.abs().max(most))
    }

    /// The pieces between the rows.
    pub(crate) fn pieces(&self) -> impl Iterator<Item = Piece> {
        (1..self.times.len()).map(|k| {
            let duration = self.times[k] - self.times[k - 1];
            let slopes = self.rates.get(k - 1..=k).map(|rates| [duration * rates[0], duration * rates[1]]);
            Piece { duration, ends: [self.accelerations[k - 1], self.accelerations[k]], slopes }
        })
    }
}
