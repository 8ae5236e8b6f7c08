//! A = K + sM without the held rows and columns, column by column from K and M as they are.

use faer::Mat;
use faer::MatRef;
use faer::sparse::{FaerError, SparseColMat, SparseColMatRef, SymbolicSparseColMat, SymbolicSparseColMatRef};

use crate::constraints::Constraints;
use crate::products::symmetric_product;

/// K + sM; held rows and columns are those of the identity.
pub(crate) struct ShiftedMatrix<'a> {
    pub stiffness: SparseColMatRef<'a, usize, f64>,
    pub mass: SparseColMatRef<'a, usize, f64>,
    pub shift: f64,
    pub constraints: &'a Constraints,
}

/// Where the entries of K + sM are.
pub(crate) enum Pattern<'a> {
    /// Where those of K are.
    OfStiffness(SymbolicSparseColMatRef<'a, usize>),
    /// Where K or M have some.
    OfBoth(SymbolicSparseColMat<usize>),
}

impl Pattern<'_> {
    pub(crate) fn as_ref(&self) -> SymbolicSparseColMatRef<'_, usize> {
        match self {
            Self::OfStiffness(pattern) => *pattern,
            Self::OfBoth(pattern) => pattern.as_ref(),
        }
    }
}

impl<'a> ShiftedMatrix<'a> {
    /// Its pattern; zeros that are stored stay stored.
    pub(crate) fn pattern(&self) -> Result<Pattern<'a>, FaerError> {
        let (k, m) = (self.stiffness.symbolic(), self.mass.symbolic());
        if k.col_ptr() == m.col_ptr() && k.row_idx() == m.row_idx() {
            return Ok(Pattern::OfStiffness(k));
        }
        Ok(Pattern::OfBoth(faer::sparse::ops::union_symbolic(k, m)?))
    }

    /// Calls `add` with the row and the value of each entry of a column, some rows twice.
    pub(crate) fn add_column(&self, column: usize, mut add: impl FnMut(usize, f64)) {
        if self.constraints.holds(column) {
            return add(column, 1.0);
        }
        let free = |row: usize| !self.constraints.holds(row);
        for (row, value) in self.stiffness.row_idx_of_col(column).zip(self.stiffness.val_of_col(column)) {
            if free(row) {
                add(row, *value);
            }
        }
        for (row, value) in self.mass.row_idx_of_col(column).zip(self.mass.val_of_col(column)) {
            if free(row) {
                add(row, self.shift * value);
            }
        }
    }

    /// (K + sM)·X, the held rows and columns with it.
    pub(crate) fn product_with_held(&self, x: MatRef<'_, f64>) -> Mat<f64> {
        symmetric_product(self.stiffness, x) + faer::Scale(self.shift) * symmetric_product(self.mass, x)
    }

    /// Itself, on a pattern that has all its entries.
    pub(crate) fn assembled(&self, pattern: &Pattern<'_>) -> Result<SparseColMat<usize, f64>, FaerError> {
        let mut matrix = SparseColMat::new(pattern.as_ref().to_owned()?, vec![0.0; pattern.as_ref().row_idx().len()]);
        let (symbolic, values) = matrix.parts_mut();
        for column in 0..symbolic.ncols() {
            let range = symbolic.col_range(column);
            let rows = &symbolic.row_idx()[range.clone()];
            let values = &mut values[range];
            self.add_column(column, |row, value| values[rows.partition_point(|other| *other < row)] += value);
        }
        Ok(matrix)
    }
}
