//! The error of the mesh in the stress of a body whose modes may be about a bent rest, Eq. (S3) of `docs/method/stress.md`.
//!
//! About a bent rest u₀ the strain of a small displacement u is sym(F₀ᵀ∇u), F₀ = 1 + ∇u₀. sym(∇u) alone would have the turning of u₀ in it,
//! which strains nothing.

use faer::{Col, MatRef};
use fem_tet10::{AssemblyError, StressError, StressRecovery};

use crate::model::Meshed;

/// Displacement fields that are seen at once, which bounds the room for their errors.
const BLOCK: usize = 32;

impl Meshed {
    /// The error in each element of small displacements (3n×k) from the rest of the modes: `see` is given blocks of displacements one
    /// after another: their number, and the errors by element, then by displacement.
    ///
    /// # Errors
    /// [`AssemblyError`].
    pub fn mesh_errors(
        &self,
        recovery: &StressRecovery<'_>,
        displacements: MatRef<'_, f64>,
        mut see: impl FnMut(usize, &[StressError]),
    ) -> Result<(), AssemblyError> {
        for first in (0..displacements.ncols()).step_by(BLOCK) {
            let count = BLOCK.min(displacements.ncols() - first);
            let block = displacements.subcols(first, count);
            let errors = match &self.reference {
                None => recovery.error_estimate(block)?,
                Some(reference) => recovery.error_estimate_of_product(block, (reference.col(0), block))?,
            };
            see(count, &errors);
        }
        Ok(())
    }

    /// The error in each element of a state: of the rest of the modes and small modal displacements from it.
    ///
    /// # Errors
    /// [`AssemblyError`].
    pub fn mesh_error_of_state(
        &self,
        recovery: &StressRecovery<'_>,
        modal_displacement: &[f64],
    ) -> Result<Vec<StressError>, AssemblyError> {
        let displacement = &self.modes.shapes * Col::from_iter(modal_displacement.iter().copied());
        let displacement = displacement.as_mat();
        let Some(reference) = &self.reference else {
            return recovery.error_estimate(displacement);
        };
        // E(u₀) + sym(F₀ᵀ∇u) = sym ∇(u₀ + u) + sym(∇u₀ᵀ∇(½u₀ + u)).
        let rest = reference.col(0);
        let whole = Col::from_fn(rest.nrows(), |i| rest[i] + displacement[(i, 0)]);
        let half = Col::from_fn(rest.nrows(), |i| 0.5 * rest[i] + displacement[(i, 0)]);
        recovery.error_estimate_of_product(whole.as_mat(), (rest, half.as_mat()))
    }
}
