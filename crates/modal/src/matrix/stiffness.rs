//! The stiffness matrix of a body: by pairs of nodes where it comes as that, in compressed columns otherwise.

use faer::sparse::SparseColMatRef;
use faer::{Mat, MatMut, MatRef};

use crate::error::ModalError;
use crate::matrix::columns::Columns;
use crate::matrix::node_pairs::NodePairs;
use crate::matrix::pattern::Pattern;
use crate::matrix::products::{NodeBlocks, Packed, blocks_product, symmetric_product_into};
use crate::matrix::symmetry::check_symmetric_blocks;

/// The symmetric stiffness matrix of a body.
#[derive(Debug, Clone, Copy)]
pub enum StiffnessMatrix<'a> {
    /// A 3×3 block for each pair of coupled nodes.
    Nodal(NodalStiffness<'a>),
    /// Any other, both triangles stored.
    General(SparseColMatRef<'a, usize, f64>),
}

/// A stiffness matrix (3n×3n) of 3×3 blocks, both triangles stored: an index for each pair of nodes, where compressed
/// columns have nine.
#[derive(Debug, Clone, Copy)]
pub struct NodalStiffness<'a> {
    pairs: NodePairs<'a>,
    values: &'a [f64],
}

impl<'a> NodalStiffness<'a> {
    /// `nodes[start[j]..start[j + 1]]` are the nodes that node j is coupled to, itself too, in rising order. `values` are the
    /// entries column by column as compressed columns have them: of each node the columns of its three axes, in each the
    /// rows of the three axes of each of those nodes.
    ///
    /// # Errors
    /// [`ModalError::Length`], [`ModalError::Unsorted`] and [`ModalError::NoNode`] where the lists do not fit together.
    pub fn new(start: &'a [usize], nodes: &'a [u32], values: &'a [f64]) -> Result<Self, ModalError> {
        let pairs = NodePairs::new(start, nodes)?;
        if values.len() != 9 * nodes.len() {
            let what = "the entries of the stiffness matrix";
            return Err(ModalError::Length { what, found: values.len(), expected: 9 * nodes.len() });
        }
        Ok(Self { pairs, values })
    }

    /// The stiffness of lists that are known to fit together.
    pub(crate) fn of_checked(start: &'a [usize], nodes: &'a [u32], values: &'a [f64]) -> Self {
        Self { pairs: NodePairs { start, nodes }, values }
    }

    /// Refuses entries that are not finite, and triangles that differ.
    pub(crate) fn check(&self) -> Result<(), ModalError> {
        let NodePairs { start, nodes } = self.pairs;
        if let Some(entry) = first_not_finite(self.values) {
            // The last node whose blocks begin at the entry or before it.
            let node = start.partition_point(|first| 9 * first <= entry) - 1;
            let index = 3 * node + (entry - 9 * start[node]) / (3 * (start[node + 1] - start[node]));
            return Err(ModalError::NotFinite { what: "stiffness", place: "column", index, value: self.values[entry] });
        }
        check_symmetric_blocks("stiffness", start, nodes, self.values)
    }

    /// The pairs of nodes that have a block.
    pub(crate) fn pairs(&self) -> NodePairs<'a> {
        self.pairs
    }

    /// The column of an axis of a node: the nodes of its rows, and the entries along the three axes of each.
    #[inline(always)]
    pub(crate) fn column(&self, node: usize, axis: usize) -> (&'a [u32], &'a [[f64; 3]]) {
        let nodes = self.pairs.of(node);
        let first = 9 * self.pairs.start[node] + 3 * axis * nodes.len();
        (nodes, self.values[first..first + 3 * nodes.len()].as_chunks().0)
    }

    /// The same, for products.
    pub(crate) fn blocks(&self) -> NodeBlocks<'a> {
        NodeBlocks { start: self.pairs.start, nodes: self.pairs.nodes, values: self.values }
    }
}

/// The place of the first number that is not finite.
fn first_not_finite(values: &[f64]) -> Option<usize> {
    const CHUNK: usize = 1024;
    // Chunks without a way out are compiled to vector instructions.
    let chunk = values.chunks(CHUNK).position(|chunk| !chunk.iter().fold(true, |all, v| all & v.is_finite()))?;
    values[CHUNK * chunk..].iter().position(|v| !v.is_finite()).map(|place| CHUNK * chunk + place)
}

impl<'a> From<SparseColMatRef<'a, usize, f64>> for StiffnessMatrix<'a> {
    fn from(matrix: SparseColMatRef<'a, usize, f64>) -> Self {
        Self::General(matrix)
    }
}

impl<'a> From<NodalStiffness<'a>> for StiffnessMatrix<'a> {
    fn from(matrix: NodalStiffness<'a>) -> Self {
        Self::Nodal(matrix)
    }
}

impl<'a> StiffnessMatrix<'a> {
    /// Stored entries.
    pub(crate) fn entries(&self) -> usize {
        match self {
            Self::Nodal(matrix) => matrix.values.len(),
            Self::General(matrix) => matrix.row_idx().len(),
        }
    }

    /// Memory held, bytes.
    pub(crate) fn bytes(&self) -> usize {
        match self {
            Self::Nodal(matrix) => 8 * matrix.values.len() + matrix.pairs.bytes(),
            Self::General(matrix) => 16 * matrix.row_idx().len() + 8 * matrix.ncols(),
        }
    }

    /// K·X.
    pub(crate) fn product(&self, x: MatRef<'_, f64>) -> Mat<f64> {
        let mut y = Mat::zeros(x.nrows(), x.ncols());
        self.product_into(x, y.as_mut(), &mut Vec::new());
        y
    }

    /// Y = K·X; `packed` is scratch that can be used again.
    pub(crate) fn product_into(&self, x: MatRef<'_, f64>, y: MatMut<'_, f64>, packed: &mut Vec<Packed>) {
        match self {
            Self::Nodal(matrix) => blocks_product(matrix.blocks(), x, y, packed),
            Self::General(matrix) => symmetric_product_into(*matrix, x, y, packed),
        }
    }

    /// Where its entries on and below the diagonal are; of a general one, also those above.
    pub(crate) fn pattern(&self) -> Pattern<'a> {
        match self {
            Self::Nodal(matrix) => Pattern::Made(matrix.pairs.lower(3)),
            Self::General(matrix) => Pattern::Given(matrix.symbolic()),
        }
    }

    /// The diagonal.
    pub(crate) fn diagonal(&self) -> Vec<f64> {
        let of_column = |column: usize| {
            let mut found = 0.0;
            self.for_each_in_column(column, |row, value| {
                if row == column {
                    found = value;
                }
            });
            found
        };
        (0..self.ncols()).map(of_column).collect()
    }
}

impl Columns for StiffnessMatrix<'_> {
    fn ncols(&self) -> usize {
        match self {
            Self::Nodal(matrix) => 3 * matrix.pairs.count(),
            Self::General(matrix) => matrix.ncols(),
        }
    }

    #[inline(always)]
    fn for_each_in_column(&self, column: usize, mut entry: impl FnMut(usize, f64)) {
        match self {
            Self::Nodal(matrix) => {
                let (nodes, values) = matrix.column(column / 3, column % 3);
                for (node, values) in nodes.iter().zip(values) {
                    for (axis, value) in values.iter().enumerate() {
                        entry(3 * *node as usize + axis, *value);
                    }
                }
            }
            Self::General(matrix) => {
                matrix
                    .row_idx_of_col(column)
                    .zip(matrix.val_of_col(column))
                    .for_each(|(row, value)| entry(row, *value));
            }
        }
    }
}
