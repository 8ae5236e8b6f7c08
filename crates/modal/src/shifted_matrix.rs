//! A = K + sM without the held rows and columns, column by column from K and M as they are.

use faer::Mat;
use faer::MatRef;
use faer::sparse::{FaerError, SparseColMat, SparseColMatRef, SymbolicSparseColMat, SymbolicSparseColMatRef};

use crate::constraints::Constraints;
use crate::products::symmetric_product;

/// K + sM; held rows and columns are those of the identity.
pub(crate) struct ShiftedMatrix<'a> {
    stiffness: SparseColMatRef<'a, usize, f64>,
    mass: SparseColMatRef<'a, usize, f64>,
    shift: f64,
    constraints: &'a Constraints,
    /// The entries of K and M are at the same places.
    is_one_pattern: bool,
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
    pub(crate) fn new(
        stiffness: SparseColMatRef<'a, usize, f64>,
        mass: SparseColMatRef<'a, usize, f64>,
        shift: f64,
        constraints: &'a Constraints,
    ) -> Self {
        // The matrices of an assembly share one pattern: nothing has to be compared.
        let same = |k: &[usize], m: &[usize]| std::ptr::eq(k, m) || k == m;
        let is_one_pattern = same(stiffness.col_ptr(), mass.col_ptr()) && same(stiffness.row_idx(), mass.row_idx());
        Self { stiffness, mass, shift, constraints, is_one_pattern }
    }

    /// The shift s.
    pub(crate) fn shift(&self) -> f64 {
        self.shift
    }

    /// Its pattern; zeros that are stored stay stored.
    pub(crate) fn pattern(&self) -> Result<Pattern<'a>, FaerError> {
        let (k, m) = (self.stiffness.symbolic(), self.mass.symbolic());
        if self.is_one_pattern {
            return Ok(Pattern::OfStiffness(k));
        }
        Ok(Pattern::OfBoth(faer::sparse::ops::union_symbolic(k, m)?))
    }

    /// Calls `add` with the row and the value of each entry of a column; a row may come twice.
    pub(crate) fn add_column(&self, column: usize, mut add: impl FnMut(usize, f64)) {
        if self.constraints.holds(column) {
            return add(column, 1.0);
        }
        let free = |row: usize| !self.constraints.holds(row);
        let k = self.stiffness.row_idx_of_col(column).zip(self.stiffness.val_of_col(column));
        if self.is_one_pattern {
            for ((row, k), m) in k.zip(self.mass.val_of_col(column)).filter(|((row, _), _)| free(*row)) {
                add(row, k + self.shift * m);
            }
            return;
        }
        let m = self.mass.row_idx_of_col(column).zip(self.mass.val_of_col(column));
        k.filter(|(row, _)| free(*row)).for_each(|(row, k)| add(row, *k));
        m.filter(|(row, _)| free(*row)).for_each(|(row, m)| add(row, self.shift * m));
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
