//! What an effect amounts to, and whether it is on.

use crate::row::{Effect, Row};

/// Deflection over length at which linear strain ends.
pub(crate) const LINEAR: f64 = 0.1;

/// A row but for the decision.
pub(crate) struct Estimate {
    pub effect: Effect,
    pub value: f64,
    pub influence: f64,
    pub why: String,
}

impl Estimate {
    /// The row, with the decision.
    pub(crate) fn row(self, tolerance: f64) -> Row {
        let Self { effect, value, influence, why } = self;
        let on = match effect {
            Effect::Deflection => value >= LINEAR,
            _ => influence >= tolerance || influence.is_nan(),
        };
        Row { effect, value, influence, on, why }
    }
}
