//! Models of lower order.

use std::str::FromStr;

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
pub struct Reduced {
    /// The model.
    pub model: StateSpace,
    /// Error bound and Hankel values of a balanced truncation.
    pub balanced: Option<(f64, Vec<f64>)>,
}

impl FromStr for Reduction {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let order = |text: &str| text.parse().ok().filter(|order: &usize| *order > 0);
        let found = text.split_once(':').and_then(|(way, text)| match way {
            "balanced" => order(text).map(Self::Balanced),
            "modal" => order(text).map(Self::Modal),
            _ => None,
        });
        found.ok_or_else(|| "expected balanced:N or modal:N, such as balanced:12".to_owned())
    }
}

impl Reduction {
    /// The model of lower order of a state space.
    ///
    /// # Errors
    /// [`LinearError`], e.g. for an order below the number of states that do not decay.
    pub fn of(self, space: &StateSpace) -> Result<Reduced, LinearError> {
        Ok(match self {
            Self::Balanced(order) => {
                let Balanced { model, hankel_values, error_bound, .. } = space.balanced(order)?;
                Reduced { model, balanced: Some((error_bound, hankel_values)) }
            }
            Self::Modal(order) => Reduced { model: space.modal(order)?, balanced: None },
        })
    }
}
