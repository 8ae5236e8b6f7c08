//! The state space of a scene, whole and of lower order.

use linear::StateSpace;

use super::reduction::Reduced;
use super::state::State;

/// The state space of a scene.
#[derive(Debug, Clone)]
pub struct LinearSpace {
    /// The whole.
    pub whole: StateSpace,
    /// A model of lower order.
    pub reduced: Option<Reduced>,
    /// The state that it is about.
    pub state: State,
}

impl LinearSpace {
    /// The model of lower order, or the whole where there is none.
    pub fn model(&self) -> &StateSpace {
        self.reduced.as_ref().map_or(&self.whole, |reduced| &reduced.model)
    }

    /// Error bound and Hankel values of a balanced truncation.
    pub fn balanced(&self) -> Option<&(f64, Vec<f64>)> {
        self.reduced.as_ref()?.balanced.as_ref()
    }
}
