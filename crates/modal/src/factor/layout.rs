//! How the entries of a factor with supernodes stand in memory.
//!
//! A supernode has its own rows first, without the entries above the diagonal, then the rows below. The columns go by
//! passes, the columns of a pass row by row, as a substitution reads them. While the factor is made, the rows below stand
//! column by column.

use std::iter::StepBy;
use std::ops::Range;

/// Columns of the factor that are applied in one pass over the rows below them.
pub(crate) const COLUMNS: usize = 6;
/// Columns of a node with three degrees of freedom.
pub(crate) const NODE: usize = 3;
/// Rows below a supernode that are taken together: they stay in the processor's first cache.
pub(crate) const STRIP: usize = 128;

/// The first columns of the passes over a supernode.
pub(crate) type Passes = StepBy<Range<usize>>;

/// The passes over [`COLUMNS`], over [`NODE`] and over single columns.
#[inline(always)]
pub(crate) fn passes(width: usize) -> [Passes; 3] {
    let of_most = width - width % COLUMNS;
    let of_nodes = width - (width - of_most) % NODE;
    [(0..of_most).step_by(COLUMNS), (of_most..of_nodes).step_by(NODE), (of_nodes..width).step_by(1)]
}

/// Entries of the own rows of a supernode of `width` columns.
#[inline(always)]
pub(crate) fn of_own_rows(width: usize) -> usize {
    let of = |passes: Passes, columns: usize| passes.map(|first| columns * (width - first)).sum::<usize>();
    let [most, nodes, single] = passes(width);
    of(most, COLUMNS) + of(nodes, NODE) + of(single, 1)
}

/// Writes the own rows of a supernode, which stand column by column in `from`. What the passes have above the diagonal
/// becomes zero.
pub(crate) fn write_own_rows(width: usize, from: &[f64], mut to: &mut [f64]) {
    let [most, nodes, single] = passes(width);
    for first in most {
        to = write_own_pass::<COLUMNS>(from, width, first, to);
    }
    for first in nodes {
        to = write_own_pass::<NODE>(from, width, first, to);
    }
    for first in single {
        to = write_own_pass::<1>(from, width, first, to);
    }
}

/// Writes K columns from `first` on, from the diagonal on. Returns the rest of `to`.
fn write_own_pass<'a, const K: usize>(from: &[f64], width: usize, first: usize, to: &'a mut [f64]) -> &'a mut [f64] {
    let (pass, rest) = to.split_at_mut(K * (width - first));
    write_pass::<K>(from, width, first, first..width, pass);
    for (i, row) in pass.as_chunks_mut::<K>().0.iter_mut().take(K).enumerate() {
        row[i + 1..].fill(0.0);
    }
    rest
}

/// Writes rows, which stand column by column in `from`, by strips.
pub(crate) fn write_strips(width: usize, from: &[f64], mut to: &mut [f64]) {
    let rows = from.len() / width;
    for strip in (0..rows).step_by(STRIP).map(|first| first..rows.min(first + STRIP)) {
        let [most, nodes, single] = passes(width);
        for first in most {
            to = write_pass::<COLUMNS>(from, rows, first, strip.clone(), to);
        }
        for first in nodes {
            to = write_pass::<NODE>(from, rows, first, strip.clone(), to);
        }
        for first in single {
            to = write_pass::<1>(from, rows, first, strip.clone(), to);
        }
    }
}

/// Writes some rows of K columns from `first` on, row by row; `from` has columns of `height` rows. Returns the rest of `to`.
fn write_pass<'a, const K: usize>(
    from: &[f64],
    height: usize,
    first: usize,
    rows: Range<usize>,
    to: &'a mut [f64],
) -> &'a mut [f64] {
    let columns: [&[f64]; K] = std::array::from_fn(|k| &from[(first + k) * height..][rows.clone()]);
    let (to, rest) = to.split_at_mut(K * rows.len());
    for (i, to) in to.as_chunks_mut::<K>().0.iter_mut().enumerate() {
        *to = std::array::from_fn(|k| columns[k][i]);
    }
    rest
}

#[cfg(test)]
pub(crate) mod tests {
    use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;

    use super::*;

    /// A factor of faer's in this layout, as it is before it is interleaved.
    pub(crate) fn of_faer(symbolic: &SymbolicSupernodalCholesky<usize>, values: &[f64]) -> Vec<f64> {
        let mut all = Vec::new();
        for s in 0..symbolic.n_supernodes() {
            let width = symbolic.supernode_end()[s] - symbolic.supernode_begin()[s];
            let rows = width + symbolic.supernode(s).pattern().len();
            let columns = || values[symbolic.col_ptr_for_val()[s]..].chunks(rows).take(width);
            let own: Vec<f64> = columns().flat_map(|column| &column[..width]).copied().collect();
            let before = all.len();
            all.resize(before + of_own_rows(width), 0.0);
            write_own_rows(width, &own, &mut all[before..]);
            all.extend(columns().flat_map(|column| &column[width..]));
        }
        all
    }

    #[test]
    fn own_rows_and_strips_stand_as_they_are_read() {
        // Nine columns and one: passes of six, three and one.
        let width = 10;
        assert_eq!(of_own_rows(width), 6 * 10 + 3 * 4 + 1);
        let own: Vec<f64> = (0..width * width).map(|entry| entry as f64).collect();
        let mut written = vec![-1.0; of_own_rows(width)];
        write_own_rows(width, &own, &mut written);
        let at = |row: usize, column: usize| (column * width + row) as f64;
        assert_eq!(written[..12], [at(0, 0), 0.0, 0.0, 0.0, 0.0, 0.0, at(1, 0), at(1, 1), 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(written[60..66], [at(6, 6), 0.0, 0.0, at(7, 6), at(7, 7), 0.0]);
        assert_eq!(written[72], at(9, 9));

        let rows = STRIP + 2;
        let below: Vec<f64> = (0..width * rows).map(|entry| entry as f64).collect();
        let mut written = vec![-1.0; width * rows];
        write_strips(width, &below, &mut written);
        let at = |row: usize, column: usize| (column * rows + row) as f64;
        assert_eq!(written[6..8], [at(1, 0), at(1, 1)]);
        assert_eq!(written[9 * STRIP + 1], at(1, 9));
        assert_eq!(written[width * STRIP..width * STRIP + 2], [at(STRIP, 0), at(STRIP, 1)]);
        let mut sorted = written.clone();
        sorted.sort_by(f64::total_cmp);
        assert_eq!(sorted, below);
    }
}
