//! Mass and stiffness of a body, wherever they come from.

use faer::sparse::{SparseColMat, SparseColMatRef};
use fem_tet10::Matrices;
use modal::{ModalError, NodalMass, NodalStiffness, Solver, Support};

/// K and M (N×N).
pub(crate) enum FeMatrices {
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

    /// The solver of modes and statics.
    pub fn solver<'a>(&'a self, positions: &'a [[f64; 3]], support: &Support) -> Result<Solver<'a>, ModalError> {
        match self {
            Self::Assembled(matrices) => {
                let (start, nodes) = (matrices.start(), matrices.nodes());
                let stiffness = NodalStiffness::new(start, nodes, matrices.stiffness_by_nodes())?;
                let mass = NodalMass::of_nodes(start, nodes, matrices.mass_by_nodes())?;
                Solver::of_nodes(stiffness, mass, positions, support)
            }
            Self::Given { stiffness, mass } => Solver::new(stiffness.as_ref(), mass.as_ref(), positions, support),
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
