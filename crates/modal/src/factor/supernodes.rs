//! The pattern of a factor by supernodes: runs of columns that have the same rows below them.

use std::ops::Range;

use faer::Index;
use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;

use crate::factor::layout::of_own_rows;

/// The supernodes of a factor, and where their numbers stand ([`factor_layout`](crate::factor::layout)).
pub(crate) struct Supernodes {
    /// The first column of each, then the number of columns.
    columns: Vec<usize>,
    /// Where each begins in `rows`, then their number.
    starts: Vec<usize>,
    rows: Vec<u32>,
    /// Where each begins in the factor, then the number of its entries.
    entries: Vec<usize>,
}

impl Supernodes {
    /// Takes the pattern of a factor, each column and row of which stands for `alike` degrees of freedom that are coupled alike.
    pub(crate) fn new<I: Index>(symbolic: &SymbolicSupernodalCholesky<I>, alike: usize) -> Self {
        let count = symbolic.n_supernodes();
        let (mut columns, mut starts, mut entries) = (vec![0], vec![0], vec![0]);
        let mut rows = Vec::with_capacity(alike * symbolic.row_idx().len());
        let mut end = 0;
        for s in 0..count {
            let columns_end = alike * symbolic.supernode_end()[s].zx();
            let pattern = symbolic.supernode(s).pattern();
            rows.extend(pattern.iter().flat_map(|row| (0..alike).map(|k| (alike * row.zx() + k) as u32)));
            let width = columns_end - columns[s];
            end += of_own_rows(width) + width * alike * pattern.len();
            columns.push(columns_end);
            starts.push(rows.len());
            entries.push(end);
        }
        Self { columns, starts, rows, entries }
    }

    /// How many there are.
    pub(crate) fn count(&self) -> usize {
        self.columns.len() - 1
    }

    /// Columns of the factor.
    pub(crate) fn unknowns(&self) -> usize {
        self.columns.last().copied().unwrap_or(0)
    }

    /// Entries of the factor.
    pub(crate) fn factor_entries(&self) -> usize {
        self.entries.last().copied().unwrap_or(0)
    }

    /// Columns of a supernode.
    #[inline(always)]
    pub(crate) fn columns(&self, s: usize) -> Range<usize> {
        self.columns_of(&(s..s + 1))
    }

    /// Columns of some supernodes, one after another.
    #[inline(always)]
    pub(crate) fn columns_of(&self, supernodes: &Range<usize>) -> Range<usize> {
        self.columns[supernodes.start]..self.columns[supernodes.end]
    }

    /// Number of columns of a supernode.
    #[inline(always)]
    pub(crate) fn width(&self, s: usize) -> usize {
        self.columns(s).len()
    }

    /// Rows below a supernode, in rising order.
    #[inline(always)]
    pub(crate) fn below(&self, s: usize) -> &[u32] {
        &self.rows[self.starts[s]..self.starts[s + 1]]
    }

    /// Where the numbers of a supernode stand.
    #[inline(always)]
    pub(crate) fn entries(&self, s: usize) -> Range<usize> {
        self.entries_of(&(s..s + 1))
    }

    /// Range of the numbers of some supernodes, one after another.
    #[inline(always)]
    pub(crate) fn entries_of(&self, supernodes: &Range<usize>) -> Range<usize> {
        self.entries[supernodes.start]..self.entries[supernodes.end]
    }

    /// The supernode of each column.
    pub(crate) fn of_columns(&self) -> Vec<u32> {
        (0..self.count()).flat_map(|s| self.columns(s).map(move |_| s as u32)).collect()
    }

    /// Multiplications that make the factor: a column with c entries below its diagonal takes (c+1)²/2.
    pub(crate) fn multiplications(&self) -> f64 {
        let of_supernode = |s: usize| -> f64 {
            let below = self.below(s).len();
            (1..=self.width(s)).map(|column| ((below + column) as f64).powi(2) / 2.0).sum()
        };
        (0..self.count()).map(of_supernode).sum()
    }

    /// Memory held, bytes.
    pub(crate) fn bytes(&self) -> usize {
        4 * self.rows.len() + 8 * (self.columns.len() + self.starts.len() + self.entries.len())
    }
}

#[cfg(test)]
mod tests {
    use faer::sparse::linalg::cholesky::SymbolicCholeskyRaw;
    use faer::sparse::{SparseColMat, Triplet};

    use super::*;
    use crate::factor::substitution::tests::{grid, supernodal, supernodal_in_order};

    /// The rows on and below the diagonal of each column.
    fn columns(supernodes: &Supernodes) -> Vec<Vec<usize>> {
        let of = |s: usize, column: usize| {
            let own = column..supernodes.columns(s).end;
            own.chain(supernodes.below(s).iter().map(|row| *row as usize)).collect()
        };
        (0..supernodes.count()).flat_map(|s| supernodes.columns(s).map(move |column| of(s, column))).collect()
    }

    #[test]
    fn the_pattern_of_nodes_is_that_of_their_degrees_of_freedom() {
        let nodes = grid(7);
        let expanded = |k: usize| 3 * k..3 * k + 3;
        let entries = nodes.triplet_iter().flat_map(|entry| {
            expanded(entry.row).flat_map(move |i| expanded(entry.col).map(move |j| Triplet::new(i, j, *entry.val)))
        });
        let size = 3 * nodes.ncols();
        let dofs = SparseColMat::try_new_from_triplets(size, size, &entries.collect::<Vec<_>>()).unwrap();
        let of_nodes = supernodal(&nodes);
        let order = of_nodes.perm().unwrap().arrays().0.iter().flat_map(|node| expanded(*node)).collect::<Vec<_>>();
        // The same order for both.
        let mut place = vec![0; size];
        order.iter().enumerate().for_each(|(new, old)| place[*old] = new);
        let moved: Vec<_> = dofs.triplet_iter().map(|e| Triplet::new(place[e.row], place[e.col], *e.val)).collect();
        let moved = SparseColMat::try_new_from_triplets(size, size, &moved).unwrap();
        let of_dofs = supernodal_in_order(&moved);
        let (SymbolicCholeskyRaw::Supernodal(a), SymbolicCholeskyRaw::Supernodal(b)) = (of_nodes.raw(), of_dofs.raw())
        else {
            panic!()
        };
        let (a, b) = (Supernodes::new(a, 3), Supernodes::new(b, 1));
        assert!(a.unknowns() == size && columns(&a) == columns(&b));
        assert_eq!(a.multiplications(), b.multiplications());
        let sum: usize = (0..a.count()).map(|s| of_own_rows(a.width(s)) + a.width(s) * a.below(s).len()).sum();
        assert_eq!([a.factor_entries(), a.entries_of(&(0..a.count())).len()], [sum; 2]);
    }
}
