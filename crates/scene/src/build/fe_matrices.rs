//! Mass and stiffness of a body, wherever they come from.

use faer::sparse::{SparseColMat, SparseColMatRef};
use fem_tet10::Matrices;

/// K and M (N×N).
pub(super) enum FeMatrices {
    /// From the elements of a mesh.
    Assembled(Matrices),
    /// From another program.
    Given { stiffness: SparseColMat<usize, f64>, mass: SparseColMat<usize, f64> },
}

impl FeMatrices {
    pub fn stiffness(&self) -> SparseColMatRef<'_, usize, f64> {
        match self {
            Self::Assembled(matrices) => matrices.stiffness(),
            Self::Given { stiffness, .. } => stiffness.as_ref(),
        }
    }

    pub fn mass(&self) -> SparseColMatRef<'_, usize, f64> {
        match self {
            Self::Assembled(matrices) => matrices.mass(),
            Self::Given { mass, .. } => mass.as_ref(),
        }
    }

    /// Memory held, in bytes.
    pub fn bytes(&self) -> usize {
        match self {
            Self::Assembled(matrices) => matrices.bytes(),
            Self::Given { stiffness, mass } => {
                let of = |matrix: &SparseColMat<usize, f64>| 16 * matrix.val().len() + 8 * (1 + matrix.ncols());
                of(stiffness) + of(mass)
            }
        }
    }
}
