//! The error of the mesh in the stress of a body whose modes may be about a bent rest, Eq. (S3) of `docs/method/stress.md`.
//!
//! About a bent rest u₀ the strain of a small displacement u is sym(F₀ᵀ∇u), F₀ = 1 + ∇u₀. sym(∇u) alone would have the turning of u₀ in it,
//! which strains nothing.

use faer::{Col, ColRef};
use fem_tet10::{AssemblyError, StressError, StressRecovery};

use crate::model::Meshed;
use crate::stress::about::stress_about;

impl Meshed {
    /// The error in each element of a small displacement (3n) from the rest of the modes.
    ///
    /// # Errors
    /// [`AssemblyError`].
    pub fn mesh_error(
        &self,
        recovery: &StressRecovery<'_>,
        displacement: ColRef<'_, f64>,
    ) -> Result<Vec<StressError>, AssemblyError> {
        match &self.reference {
            None => {
                let nodal = recovery.nodal_stress(displacement.as_mat())?;
                recovery.error_estimate(displacement, nodal.col(0))
            }
            Some(reference) => {
                let nodal = stress_about(recovery, reference.as_ref(), displacement.as_mat())?;
                recovery.error_estimate_of_product(displacement, [reference.col(0), displacement], nodal.col(0))
            }
        }
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
        let Some(reference) = &self.reference else { return self.mesh_error(recovery, displacement.as_ref()) };
        // E(u₀) + sym(F₀ᵀ∇u) = sym ∇(u₀ + u) + sym(∇u₀ᵀ∇(½u₀ + u)).
        let rest = reference.col(0);
        let whole = Col::from_fn(rest.nrows(), |i| rest[i] + displacement[i]);
        let half = Col::from_fn(rest.nrows(), |i| 0.5 * rest[i] + displacement[i]);
        let of_both = stress_about(recovery, reference.as_ref(), displacement.as_mat())?;
        let nodal = of_both.col(0) + of_both.col(1);
        recovery.error_estimate_of_product(whole.as_ref(), [rest, half.as_ref()], nodal.as_ref())
    }
}
