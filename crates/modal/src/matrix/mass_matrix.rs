//! The mass matrix of a body: a scalar for each pair of nodes where it is that, any symmetric matrix otherwise.

use faer::sparse::{SparseColMat, SparseColMatRef, Triplet};
use faer::{Mat, MatMut, MatRef, Side};

use crate::error::ModalError;
use crate::input::check_matrix;
use crate::matrix::columns::Columns;
use crate::matrix::mass::NodalMass;
use crate::matrix::pattern::Pattern;
use crate::matrix::products::{Packed, symmetric_product_into};
use crate::matrix::symmetry::check_symmetric;
use crate::matrix::tied_mass::{TiedMass, TiedPoint};

/// An eigenvalue of M, scaled to a unit diagonal, that is below zero by less than this is rounding.
const SEMIDEFINITE: f64 = 1e-10;

/// The mass matrix of a body.
#[derive(Debug, Clone)]
pub enum MassMatrix<'a> {
    /// `M_s ⊗ I₃`: three degrees of freedom a node, and the same mass along every axis.
    Nodal(NodalMass<'a>),
    /// Any symmetric positive semi-definite matrix, with three or six degrees of freedom a node.
    General(GeneralMass<'a>),
}

/// A symmetric mass matrix that need not act alike on the three axes.
#[derive(Debug, Clone)]
pub struct GeneralMass<'a> {
    pub(crate) matrix: SparseColMatRef<'a, usize, f64>,
    /// Degrees of freedom of a node: 3 or 6.
    pub(crate) dofs: usize,
    /// Its parts, where it is a scalar for each pair of nodes but for masses that move with nodes.
    tied: Option<TiedMass<'a>>,
}

/// How a mass matrix goes with a rotation of the body.
#[derive(Debug)]
pub(crate) enum Turning<'m, 'a> {
    /// It is a scalar for each pair of nodes, which commutes with rotations.
    Nodal(&'m NodalMass<'a>),
    /// It is that with points which turn as the body does: with a node of its own for each point it commutes.
    Tied(&'m TiedMass<'a>),
    /// It acts otherwise along other axes.
    Anisotropic(&'m GeneralMass<'a>),
}

impl<'a> From<NodalMass<'a>> for MassMatrix<'a> {
    fn from(mass: NodalMass<'a>) -> Self {
        Self::Nodal(mass)
    }
}

impl<'a> MassMatrix<'a> {
    /// Takes M (3n×3n or 6n×6n, both triangles stored) of `nodes` nodes.
    ///
    /// # Errors
    /// [`ModalError::Size`], [`ModalError::NotFinite`], [`ModalError::NotSymmetric`].
    pub fn new(mass: SparseColMatRef<'a, usize, f64>, nodes: usize) -> Result<Self, ModalError> {
        Self::of_dofs(mass, nodes, dofs("mass", mass.ncols(), nodes)?)
    }

    /// The same with a given number of degrees of freedom of a node.
    pub(crate) fn of_dofs(
        mass: SparseColMatRef<'a, usize, f64>,
        nodes: usize,
        dofs: usize,
    ) -> Result<Self, ModalError> {
        check_matrix("mass", mass, dofs * nodes)?;
        if dofs == 3 {
            match NodalMass::of_checked(mass) {
                Err(ModalError::AnisotropicMass { .. }) => {}
                nodal => return nodal.map(Self::Nodal),
            }
        }
        let (rows, values) = (mass.symbolic().row_idx(), mass.val());
        check_symmetric("mass", 1, mass.symbolic().col_ptr(), |entry| rows[entry], |entry| values[entry])?;
        Ok(Self::General(GeneralMass { matrix: mass, dofs, tied: None }))
    }

    /// A mass over pairs of nodes with points that move with nodes; `mass` is the matrix of both, by
    /// [`mass_with_points`](crate::mass_with_points).
    pub fn with_points(
        mass: SparseColMatRef<'a, usize, f64>,
        nodal: NodalMass<'a>,
        points: &'a [TiedPoint],
    ) -> MassMatrix<'a> {
        Self::General(GeneralMass { matrix: mass, dofs: 3, tied: Some(TiedMass::new(nodal, points)) })
    }

    /// How it goes with a rotation of the body.
    pub(crate) fn turning(&self) -> Turning<'_, 'a> {
        match self {
            Self::Nodal(mass) => Turning::Nodal(mass),
            Self::General(mass) => mass.tied.as_ref().map_or(Turning::Anisotropic(mass), Turning::Tied),
        }
    }

    /// Number of nodes n.
    pub(crate) fn nodes(&self) -> usize {
        match self {
            Self::Nodal(mass) => mass.node_count(),
            Self::General(mass) => mass.nodes(),
        }
    }

    /// Degrees of freedom of a node: 3 or 6.
    pub fn dofs(&self) -> usize {
        match self {
            Self::Nodal(_) => 3,
            Self::General(mass) => mass.dofs,
        }
    }

    /// M·X for X with a row for each degree of freedom.
    pub fn product(&self, x: MatRef<'_, f64>) -> Mat<f64> {
        let mut y = Mat::zeros(x.nrows(), x.ncols());
        self.product_into(x, y.as_mut(), &mut Vec::new());
        y
    }

    /// Y = M·X; `packed` is scratch that can be used again.
    pub(crate) fn product_into(&self, x: MatRef<'_, f64>, y: MatMut<'_, f64>, packed: &mut Vec<Packed>) {
        match self {
            Self::Nodal(mass) => mass.product_into(x, y, packed),
            Self::General(mass) => symmetric_product_into(mass.matrix, x, y, packed),
        }
    }

    /// The mass that each node stands for (n): what a unit acceleration of the whole body takes there, the mean over the
    /// three axes.
    pub fn row_sums(&self) -> Vec<f64> {
        match self {
            Self::Nodal(mass) => mass.row_sums(),
            Self::General(mass) => {
                let forces = self.product(mass.translations().as_ref());
                let of_node = |node: usize| (0..3).map(|axis| forces[(mass.dofs * node + axis, axis)]).sum::<f64>();
                (0..mass.nodes()).map(|node| of_node(node) / 3.0).collect()
            }
        }
    }

    /// True if a degree of freedom has a mass at all.
    pub(crate) fn is_massive(&self, row: usize) -> bool {
        match self {
            Self::Nodal(mass) => mass.is_massive(row / 3),
            Self::General(mass) => mass.matrix.val_of_col(row).iter().any(|value| *value != 0.0),
        }
    }

    /// Memory held, bytes.
    pub(crate) fn bytes(&self) -> usize {
        match self {
            Self::Nodal(mass) => mass.pairs().bytes() + 8 * mass.pairs().nodes.len(),
            Self::General(mass) => 16 * mass.matrix.row_idx().len() + 8 * mass.matrix.ncols(),
        }
    }

    /// Where its entries on and below the diagonal are, with the rest of their 3×3 blocks where it is a scalar for each pair
    /// of nodes; of a general one, also those above.
    pub(crate) fn pattern(&self) -> Pattern<'_> {
        match self {
            Self::Nodal(mass) => Pattern::Made(mass.pairs().lower(3)),
            Self::General(mass) => Pattern::Given(mass.matrix.symbolic()),
        }
    }

    /// Refuses a matrix that gives a motion a negative kinetic energy.
    ///
    /// # Errors
    /// [`ModalError::IndefiniteMass`], [`ModalError::Factorization`].
    pub fn check_semidefinite(&self) -> Result<(), ModalError> {
        match self {
            Self::Nodal(mass) => check_semidefinite(|| mass.entries(), mass.node_count(), 1),
            Self::General(mass) => mass.check_semidefinite(),
        }
    }
}

impl Columns for MassMatrix<'_> {
    fn ncols(&self) -> usize {
        match self {
            Self::Nodal(mass) => 3 * mass.node_count(),
            Self::General(mass) => mass.matrix.ncols(),
        }
    }

    #[inline(always)]
    fn for_each_in_column(&self, column: usize, mut entry: impl FnMut(usize, f64)) {
        match self {
            Self::Nodal(mass) => mass.column(column / 3).for_each(|(node, value)| entry(3 * node + column % 3, value)),
            Self::General(mass) => {
                let column = mass.matrix.row_idx_of_col(column).zip(mass.matrix.val_of_col(column));
                column.for_each(|(row, value)| entry(row, *value));
            }
        }
    }
}

impl GeneralMass<'_> {
    /// Number of nodes n.
    pub(crate) fn nodes(&self) -> usize {
        self.matrix.ncols() / self.dofs
    }

    /// A unit translation along each axis (N×3).
    pub(crate) fn translations(&self) -> Mat<f64> {
        Mat::from_fn(self.matrix.ncols(), 3, |i, axis| f64::from(i % self.dofs == axis))
    }

    pub(crate) fn check_semidefinite(&self) -> Result<(), ModalError> {
        let entries = || self.matrix.triplet_iter().map(|entry| Triplet::new(entry.row, entry.col, *entry.val));
        check_semidefinite(entries, self.matrix.ncols(), self.dofs)
    }
}

/// Refuses a symmetric matrix of this size that is not positive semi-definite; a node has `dofs` rows of it.
fn check_semidefinite<I: Iterator<Item = Triplet<usize, usize, f64>>>(
    matrix: impl Fn() -> I,
    size: usize,
    dofs: usize,
) -> Result<(), ModalError> {
    let mut diagonal = vec![0.0; size];
    let mut count = 0;
    for entry in matrix() {
        count += 1;
        if entry.row == entry.col {
            diagonal[entry.row] = entry.val;
        }
    }
    memory::check("the check of the mass matrix", 4 * 24 * count)?;
    let mut entries = Vec::with_capacity(count + size);
    for entry in matrix().filter(|entry| entry.val != 0.0) {
        if !(diagonal[entry.row] > 0.0 && diagonal[entry.col] > 0.0) {
            let row = if diagonal[entry.row] > 0.0 { entry.col } else { entry.row };
            return Err(ModalError::IndefiniteMass { place: Some([row / dofs, row % dofs]) });
        }
        let scale = (diagonal[entry.row] * diagonal[entry.col]).sqrt();
        entries.push(Triplet::new(entry.row, entry.col, entry.val / scale));
    }
    for (i, value) in diagonal.iter().enumerate() {
        entries.push(Triplet::new(i, i, if *value > 0.0 { SEMIDEFINITE } else { 1.0 }));
    }
    let failed = |reason: String| ModalError::Factorization { size, reason };
    let scaled = SparseColMat::<usize, f64>::try_new_from_triplets(size, size, &entries)
        .map_err(|reason| failed(reason.to_string()))?;
    match scaled.sp_cholesky(Side::Lower) {
        Ok(_) => Ok(()),
        Err(faer::sparse::linalg::LltError::Numeric(_)) => Err(ModalError::IndefiniteMass { place: None }),
        Err(faer::sparse::linalg::LltError::Generic(reason)) => Err(failed(reason.to_string())),
    }
}

/// Degrees of freedom of a node, 3 or 6, from the number of rows of a matrix.
pub(crate) fn dofs(what: &'static str, found: usize, nodes: usize) -> Result<usize, ModalError> {
    match found {
        _ if found == 0 => Err(ModalError::Size { what, expected: 3 * nodes, found }),
        _ if found == 6 * nodes => Ok(6),
        _ if found == 3 * nodes => Ok(3),
        _ => Err(ModalError::Size { what, expected: 3 * nodes, found }),
    }
}
