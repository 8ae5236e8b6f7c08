//! Models of lower order.

use linear::{Balanced, LinearError, StateSpace};

/// A way to a model of lower order. The order counts all states, those that do not decay among them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reduction {
    /// Balanced truncation.
    Balanced(usize),
    /// The slowest modes, with the static response of the others.
    Modal(usize),
}

/// A model of lower order.
#[derive(Debug, Clone)]
pub(super) struct Reduced {
    pub model: StateSpace,
    /// Error bound and Hankel values of a balanced truncation.
    pub balanced: Option<(f64, Vec<f64>)>,
}

impl Reduction {
    /// The model of lower order of a state space.
    pub(super) fn of(self, space: &StateSpace) -> Result<Reduced, LinearError> {
        Ok(match self {
            Self::Balanced(order) => {
                let Balanced { model, hankel_values, error_bound, .. } = space.balanced(order)?;
                Reduced { model, balanced: Some((error_bound, hankel_values)) }
            }
            Self::Modal(order) => Reduced { model: space.modal(order)?, balanced: None },
        })
    }
}
