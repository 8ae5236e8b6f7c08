//! The pattern of the factor of K + sM, and the order of its rows.

use faer::Side;
use faer::perm::Perm;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::linalg::{SupernodalThreshold, SymbolicSupernodalParams};
use faer::sparse::{FaerError, SymbolicSparseColMatRef};

use crate::error::ModalError;
use crate::factor::ordering::{nested_dissection, nested_dissection_of_nodes};
use crate::factor::shifted_matrix::ShiftedMatrix;
use crate::factor::subtrees::Subtrees;
use crate::factor::supernodes::Supernodes;

/// Degrees of freedom of a node where all of them are coupled alike.
const ALIKE: usize = 3;
/// Supernodes of at most this number of nodes become one with the next where at most this part of their entries would be zero: faer's
/// numbers, which are of degrees of freedom.
const OF_NODES: [(usize, f64); 4] = [(1, 1.0), (5, 0.8), (16, 0.1), (usize::MAX, 0.05)];

/// A factor before its numbers.
pub(crate) enum Symbolic {
    /// By supernodes.
    Supernodal(Supernodal),
    /// Column by column, as faer has it: of a small or a narrow matrix.
    Simplicial(SymbolicCholesky<usize>),
}

/// The pattern of a factor with supernodes.
pub(crate) struct Supernodal {
    pub order: Perm<usize>,
    pub supernodes: Supernodes,
    pub subtrees: Subtrees,
}

impl Symbolic {
    /// Orders the rows of a matrix, and finds the pattern of its factor. Where the degrees of freedom of a node are coupled
    /// alike, the pattern of the nodes tells it: a ninth of the other.
    pub(crate) fn new(matrix: &ShiftedMatrix<'_>) -> Result<Self, ModalError> {
        let (symbolic, order) = match matrix.node_pairs() {
            Some(pairs) => {
                let order = nested_dissection_of_nodes(&pairs)?;
                let params = CholeskySymbolicParams {
                    // Columns of nodes are as much shorter.
                    supernodal_flop_ratio_threshold: SupernodalThreshold(1.0 / ALIKE as f64),
                    supernodal_params: SymbolicSupernodalParams { relax: Some(&OF_NODES) },
                    ..CholeskySymbolicParams::default()
                };
                let of_nodes = factor(pairs.lower(1).as_ref(), &order.perm(1), params)?;
                if let SymbolicCholeskyRaw::Supernodal(symbolic) = of_nodes.raw() {
                    return Ok(Self::supernodal(order.perm(ALIKE), Supernodes::new(symbolic, ALIKE)));
                }
                let order = order.perm(ALIKE);
                (factor(pairs.lower(ALIKE).as_ref(), &order, CholeskySymbolicParams::default())?, order)
            }
            None => {
                let pattern = matrix.pattern().map_err(|reason| failed(matrix.size(), reason))?;
                let order = nested_dissection(pattern.as_ref())?.perm(ALIKE);
                (factor(pattern.as_ref(), &order, CholeskySymbolicParams::default())?, order)
            }
        };
        Ok(match symbolic.raw() {
            SymbolicCholeskyRaw::Supernodal(of_columns) => Self::supernodal(order, Supernodes::new(of_columns, 1)),
            SymbolicCholeskyRaw::Simplicial(_) => Self::Simplicial(symbolic),
        })
    }

    /// By these supernodes.
    pub(crate) fn supernodal(order: Perm<usize>, supernodes: Supernodes) -> Self {
        let subtrees = Subtrees::new(&supernodes);
        Self::Supernodal(Supernodal { order, supernodes, subtrees })
    }

    /// Entries of the factor.
    pub(crate) fn entries(&self) -> usize {
        match self {
            Self::Supernodal(Supernodal { supernodes, .. }) => supernodes.factor_entries(),
            Self::Simplicial(symbolic) => symbolic.len_val(),
        }
    }

    /// Multiplications that make it.
    pub(crate) fn multiplications(&self) -> f64 {
        match self {
            Self::Supernodal(Supernodal { supernodes, .. }) => supernodes.multiplications(),
            // Its columns are short, and it has no long ones by choice: it is never slow.
            Self::Simplicial(symbolic) => symbolic.len_val() as f64,
        }
    }

    /// True if there is work for more than one thread.
    pub(crate) fn is_parted(&self) -> bool {
        matches!(self, Self::Supernodal(Supernodal { subtrees, .. }) if subtrees.is_parted())
    }
}

fn factor(
    pattern: SymbolicSparseColMatRef<'_, usize>,
    order: &Perm<usize>,
    params: CholeskySymbolicParams<'_>,
) -> Result<SymbolicCholesky<usize>, ModalError> {
    let order = SymmetricOrdering::Custom(order.as_ref());
    let symbolic = factorize_symbolic_cholesky(pattern, Side::Lower, order, params);
    symbolic.map_err(|reason| failed(pattern.ncols(), reason))
}

/// The error for what faer refuses of a matrix with `size` rows.
pub(crate) fn failed(size: usize, reason: FaerError) -> ModalError {
    match reason {
        FaerError::OutOfMemory => {
            // At least a row and a value of each column were asked for.
            memory::OutOfMemory { what: "the factor of K + sM", wanted: 16 * size, left: memory::Left::Unknown }.into()
        }
        other => ModalError::Factorization { size, reason: other.to_string() },
    }
}
