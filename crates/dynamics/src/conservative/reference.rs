//! The forces of a bent reference that modes are about: `V += g·q + ½ qᵀBq`.

use crate::body::physics::ReferenceForces;
use crate::matrix::blocked_matrix::BlockedMatrix;
use crate::matrix::lists::dot;

/// g and B.
#[derive(Debug, Clone)]
pub(crate) struct Reference {
    force: Vec<f64>,
    stiffness: BlockedMatrix,
}

impl Reference {
    pub fn new(ReferenceForces { force, stiffness, .. }: &ReferenceForces) -> Self {
        Self { force: force.clone(), stiffness: BlockedMatrix::new(stiffness.as_ref()) }
    }

    /// Subtracts g + B q from the modal forces.
    pub fn subtract_force(&self, q: &[f64], out: &mut [f64]) {
        self.stiffness.each_block(q, |first, rows| {
            for ((out, g), b_q) in out[first..].iter_mut().zip(&self.force[first..]).zip(rows) {
                *out -= g + b_q;
            }
        });
    }

    /// g·q + ½ qᵀBq
    pub fn energy(&self, q: &[f64]) -> f64 {
        dot(&self.force, q) + 0.5 * self.stiffness.quadratic(q)
    }
}
