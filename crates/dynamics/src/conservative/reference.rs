//! The forces of a bent reference that modes are about: `V += g·q + ½ qᵀBq`.

use crate::body::physics::ReferenceForces;
use crate::matrix::column_major::{columns, dot};

/// g, and B column by column.
#[derive(Debug, Clone)]
pub(crate) struct Reference {
    force: Vec<f64>,
    stiffness: Vec<f64>,
}

impl Reference {
    pub fn new(ReferenceForces { force, stiffness }: &ReferenceForces) -> Self {
        Self { force: force.clone(), stiffness: columns(stiffness.as_ref()) }
    }

    /// Subtracts g + B q from the modal forces.
    pub fn subtract_force(&self, q: &[f64], out: &mut [f64]) {
        // B is symmetric.
        for ((out, g), column) in out.iter_mut().zip(&self.force).zip(self.stiffness.chunks_exact(q.len().max(1))) {
            *out -= g + dot(column, q);
        }
    }

    /// g·q + ½ qᵀBq
    pub fn energy(&self, q: &[f64]) -> f64 {
        let columns = self.stiffness.chunks_exact(q.len().max(1));
        q.iter().zip(&self.force).zip(columns).map(|((q_k, g), column)| q_k * (g + 0.5 * dot(column, q))).sum()
    }
}
