//! Forces without what the inertia of the rigid motion and the reactions of the support balance.

use faer::{Mat, MatRef};

use crate::matrix::tall;
use crate::solve::Solver;

/// A force that the inertia of the rigid motion balances to this part of itself, such as gravity on a free body,
/// strains nothing: the rest is rounding.
const BALANCED: f64 = 1e-11;

/// The balance of forces on a body by its rigid motion.
pub(crate) struct InertiaRelief<'a> {
    solver: &'a Solver<'a>,
    /// M R, as far as the support lets it act.
    m_rigid: Mat<f64>,
}

impl<'a> InertiaRelief<'a> {
    pub(crate) fn new(solver: &'a Solver<'_>) -> Self {
        let mut m_rigid = solver.mass.product(solver.rigid.shapes.as_ref());
        solver.constraints.project(m_rigid.as_mut());
        Self { solver, m_rigid }
    }

    /// The part of forces that strains the body.
    pub(crate) fn straining(&self, applied: MatRef<'_, f64>) -> Mat<f64> {
        let mut forces = applied.to_owned();
        self.balance(&mut forces);
        for (k, applied) in applied.col_iter().enumerate() {
            if forces.col(k).norm_l2() <= BALANCED * applied.norm_l2() {
                forces.col_mut(k).fill(0.0);
            }
        }
        forces
    }

    /// Takes out of forces what the support's reactions and the inertia of the rigid motion balance.
    pub(crate) fn balance(&self, forces: &mut Mat<f64>) {
        self.solver.constraints.project(forces.as_mut());
        tall::take_out(forces, self.m_rigid.as_ref(), self.solver.rigid.shapes.as_ref());
    }

    /// Takes the rigid modes out of displacements.
    pub(crate) fn unmove(&self, displacements: &mut Mat<f64>) {
        tall::take_out(displacements, self.solver.rigid.shapes.as_ref(), self.m_rigid.as_ref());
    }

    /// K u, without reactions.
    pub(crate) fn stiff(&self, displacements: &Mat<f64>) -> Mat<f64> {
        let mut forces = self.solver.stiffness.product(displacements.as_ref());
        self.solver.constraints.project(forces.as_mut());
        forces
    }
}
