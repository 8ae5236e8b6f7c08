//! A = K + sM without the held rows and columns, column by column from K and M as they are.

use faer::Mat;
use faer::MatRef;
use faer::sparse::{FaerError, SparseColMat};

use crate::matrix::columns::Columns;
use crate::matrix::mass_matrix::MassMatrix;
use crate::matrix::node_pairs::NodePairs;
use crate::matrix::pattern::Pattern;
use crate::matrix::stiffness::StiffnessMatrix;
use crate::support::constraints::Constraints;

/// K + sM; held rows and columns are those of the identity.
pub(crate) struct ShiftedMatrix<'a> {
    stiffness: StiffnessMatrix<'a>,
    mass: &'a MassMatrix<'a>,
    shift: f64,
    constraints: &'a Constraints,
    /// The pairs of coupled nodes, where K and M are over nodes and M couples some that K does not.
    union: Option<(Vec<usize>, Vec<u32>)>,
}

impl<'a> ShiftedMatrix<'a> {
    pub(crate) fn new(
        stiffness: StiffnessMatrix<'a>,
        mass: &'a MassMatrix<'a>,
        shift: f64,
        constraints: &'a Constraints,
    ) -> Self {
        let mut union = None;
        if let (StiffnessMatrix::Nodal(k), MassMatrix::Nodal(m)) = (&stiffness, mass) {
            // The matrices of an assembly share one pattern: nothing has to be compared.
            if !std::ptr::eq(k.pairs().nodes, m.pairs().nodes) && !covers(&stiffness, mass) {
                union = Some(k.pairs().union(&m.pairs()));
            }
        }
        Self { stiffness, mass, shift, constraints, union }
    }

    /// Its rows.
    pub(crate) fn size(&self) -> usize {
        self.stiffness.ncols()
    }

    /// The shift s.
    pub(crate) fn shift(&self) -> f64 {
        self.shift
    }

    /// Its pattern on and below the diagonal, and above as the case may be; zeros that are stored stay stored.
    pub(crate) fn pattern(&self) -> Result<Pattern<'a>, FaerError> {
        if let Some(pairs) = self.node_pairs() {
            return Ok(Pattern::Made(pairs.lower(3)));
        }
        let k = self.stiffness.pattern();
        if covers(&self.stiffness, self.mass) {
            return Ok(k);
        }
        Ok(Pattern::Made(faer::sparse::ops::union_symbolic(k.as_ref(), self.mass.pattern().as_ref())?))
    }

    /// The pairs of coupled nodes, where they tell its pattern.
    pub(crate) fn node_pairs(&self) -> Option<NodePairs<'_>> {
        match (&self.union, &self.stiffness, self.mass) {
            (Some((start, nodes)), ..) => Some(NodePairs { start, nodes }),
            (None, StiffnessMatrix::Nodal(k), MassMatrix::Nodal(_)) => Some(k.pairs()),
            _ => None,
        }
    }

    /// Calls `add` with the entries of a column, those of a node's rows together where K has them so: the first row, and the
    /// values. A row may come twice.
    #[inline(always)]
    pub(crate) fn add_column(&self, column: usize, mut add: impl FnMut(usize, &[f64])) {
        if self.constraints.holds(column) {
            return add(column, &[1.0]);
        }
        let free = |row: usize, value: f64| if self.constraints.holds(row) { 0.0 } else { value };
        match &self.stiffness {
            StiffnessMatrix::Nodal(matrix) => {
                let (nodes, values) = matrix.column(column / 3, column % 3);
                for (node, [x, y, z]) in nodes.iter().zip(values) {
                    let first = 3 * *node as usize;
                    add(first, &[free(first, *x), free(first + 1, *y), free(first + 2, *z)]);
                }
            }
            general => general.for_each_in_column(column, |row, value| add(row, &[free(row, value)])),
        }
        self.mass.for_each_in_column(column, |row, value| add(row, &[free(row, self.shift * value)]));
    }

    /// (K + sM)·X, the held rows and columns with it.
    pub(crate) fn product_with_held(&self, x: MatRef<'_, f64>) -> Mat<f64> {
        self.stiffness.product(x) + faer::Scale(self.shift) * self.mass.product(x)
    }

    /// Its entries on and below the diagonal, on a pattern that has them all.
    pub(crate) fn assembled(&self, pattern: &Pattern<'_>) -> Result<SparseColMat<usize, f64>, FaerError> {
        let mut matrix = SparseColMat::new(pattern.as_ref().to_owned()?, vec![0.0; pattern.as_ref().row_idx().len()]);
        let (symbolic, values) = matrix.parts_mut();
        for column in 0..symbolic.ncols() {
            let range = symbolic.col_range(column);
            let rows = &symbolic.row_idx()[range.clone()];
            let values = &mut values[range];
            self.add_column(column, |first, run| {
                for (row, value) in (first..).zip(run).filter(|(row, _)| *row >= column) {
                    values[rows.partition_point(|other| *other < row)] += value;
                }
            });
        }
        Ok(matrix)
    }
}

/// True if K has an entry wherever M has one.
fn covers(stiffness: &StiffnessMatrix<'_>, mass: &MassMatrix<'_>) -> bool {
    let covers = |column: usize| {
        let mut rows = Vec::new();
        stiffness.for_each_in_column(column, |row, _| rows.push(row));
        let mut all = true;
        mass.for_each_in_column(column, |row, _| all &= rows.binary_search(&row).is_ok());
        all
    };
    (0..stiffness.ncols()).all(covers)
}
