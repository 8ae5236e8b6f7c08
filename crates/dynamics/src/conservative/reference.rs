//! The forces of a bent reference that modes are about, and of coordinates that are coupled: `V += g·q + ½ qᵀBq`.

use faer::Mat;

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
    /// Forces of a bent reference, with the stiffness between coordinates that are coupled; `None` without either.
    pub fn of(reference: Option<&ReferenceForces>, coupling: Option<&Mat<f64>>) -> Option<Self> {
        let stiffnesses = reference.map(|of| &of.stiffness).into_iter().chain(coupling);
        let stiffness = stiffnesses.cloned().reduce(|sum, next| sum + next)?;
        let force = reference.map_or_else(|| vec![0.0; stiffness.nrows()], |of| of.force.clone());
        Some(Self { force, stiffness: BlockedMatrix::new(stiffness.as_ref()) })
    }

    /// g.
    pub fn force(&self) -> &[f64] {
        &self.force
    }

    /// B.
    pub fn stiffness(&self) -> Mat<f64> {
        self.stiffness.dense()
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
