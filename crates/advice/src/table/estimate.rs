//! Estimates: the influence of a subject, and the choice of it.

use crate::table::row::Row;

/// A row but for the decision.
pub(crate) struct Estimate {
    pub value: f64,
    pub influence: f64,
    pub why: String,
}

impl Estimate {
    /// The row, on where the influence reaches the tolerance or is not known.
    pub(crate) fn row(self, tolerance: f64) -> Row {
        let Self { value, influence, why } = self;
        Row { value, influence, on: influence >= tolerance || influence.is_nan(), why }
    }
}
