//! Mass and stiffness of a body, wherever they come from.

use faer::sparse::{SparseColMat, SparseColMatRef};
use fem_tet10::Matrices;
use modal::{MassMatrix, ModalError, NodalMass, NodalStiffness, Solver, Support, TiedPoint, mass_with_points};

/// K and M (N×N).
pub(crate) enum FeMatrices {
    /// From the elements of a mesh.
    Assembled(Matrices),
    /// The same with masses beside the body that move with its nodes, and the mass with these.
    Tied { matrices: Matrices, mass: SparseColMat<usize, f64>, points: Vec<TiedPoint> },
    /// From another program.
    Given { stiffness: SparseColMat<usize, f64>, mass: SparseColMat<usize, f64> },
}

impl FeMatrices {
    /// Matrices of elements, with masses beside the body.
    pub fn new(matrices: Matrices, points: Vec<TiedPoint>) -> Result<Self, ModalError> {
        if points.is_empty() {
            return Ok(Self::Assembled(matrices));
        }
        let mass = mass_with_points(&nodal_mass(&matrices)?, &points)?;
        Ok(Self::Tied { matrices, mass, points })
    }

    pub fn stiffness(&self) -> SparseColMatRef<'_, usize, f64> {
        match self {
            Self::Assembled(matrices) | Self::Tied { matrices, .. } => matrices.stiffness(),
            Self::Given { stiffness, .. } => stiffness.as_ref(),
        }
    }

    pub fn mass(&self) -> SparseColMatRef<'_, usize, f64> {
        match self {
            Self::Assembled(matrices) => matrices.mass(),
            Self::Tied { mass, .. } | Self::Given { mass, .. } => mass.as_ref(),
        }
    }

    /// The solver of modes and statics.
    pub fn solver<'a>(&'a self, positions: &'a [[f64; 3]], support: &Support) -> Result<Solver<'a>, ModalError> {
        match self {
            Self::Assembled(matrices) => {
                Solver::of_nodes(nodal_stiffness(matrices)?, nodal_mass(matrices)?, positions, support)
            }
            Self::Tied { matrices, mass, points } => {
                let mass = MassMatrix::with_points(mass.as_ref(), nodal_mass(matrices)?, points);
                Solver::of_nodes(nodal_stiffness(matrices)?, mass, positions, support)
            }
            Self::Given { stiffness, mass } => Solver::new(stiffness.as_ref(), mass.as_ref(), positions, support),
        }
    }

    /// Memory held, in bytes.
    pub fn bytes(&self) -> usize {
        match self {
            Self::Assembled(matrices) => matrices.bytes(),
            Self::Tied { matrices, mass, .. } => matrices.bytes() + bytes(mass),
            Self::Given { stiffness, mass } => bytes(stiffness) + bytes(mass),
        }
    }
}

fn bytes(matrix: &SparseColMat<usize, f64>) -> usize {
    16 * matrix.val().len() + 8 * (1 + matrix.ncols())
}

fn nodal_stiffness(matrices: &Matrices) -> Result<NodalStiffness<'_>, ModalError> {
    NodalStiffness::new(matrices.start(), matrices.nodes(), matrices.stiffness_by_nodes())
}

fn nodal_mass(matrices: &Matrices) -> Result<NodalMass<'_>, ModalError> {
    NodalMass::of_nodes(matrices.start(), matrices.nodes(), matrices.mass_by_nodes())
}
