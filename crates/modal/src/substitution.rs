//! Forward and backward substitution with a supernodal factor, `L Lᵀ = P A Pᵀ`, for several vectors at once.
//!
//! The numbers of a row lie side by side. So the factor, which is far larger than the processor's cache, is read once for
//! all vectors of a group, and a row of them is one run of memory wherever it is.

use faer::MatMut;
use faer::perm::PermRef;
use faer::reborrow::{Reborrow, ReborrowMut};
use faer::sparse::linalg::cholesky::supernodal::SupernodalLltRef;
use pulp::Arch;
use rayon::prelude::*;

/// Vectors of a group at the most.
const MOST: usize = 16;
/// Vectors of a group are a multiple of this, which is filled up.
const STEP: usize = 4;
/// Columns of the factor that are applied in one pass over the rows below them.
const COLUMNS: usize = 4;

/// Scratch of one group: the vectors row by row in the order of the factor, and the rows below a supernode.
#[derive(Default)]
pub(crate) struct Scratch {
    rows: Vec<f64>,
    below: Vec<f64>,
}

/// How many numbers [`solve`] takes as scratch for so many rows and columns.
pub(crate) fn scratch(rows: usize, columns: usize) -> usize {
    2 * rows * columns.next_multiple_of(STEP)
}

/// Replaces `x` (N×k) by A⁻¹ x. `scratch` can be used again. The result does not depend on the number of threads.
pub(crate) fn solve(
    factor: SupernodalLltRef<'_, usize, f64>,
    order: PermRef<'_, usize>,
    mut x: MatMut<'_, f64>,
    scratch: &mut Vec<Scratch>,
) {
    // Threads share the vectors; one alone reads the factor as seldom as may be.
    let groups = x.ncols().div_ceil(if rayon::current_num_threads() > 1 { STEP } else { MOST });
    let width = x.ncols().div_ceil(groups.max(1)).next_multiple_of(STEP).max(STEP);
    scratch.resize_with(scratch.len().max(groups), Scratch::default);
    let arch = Arch::new();
    let (to, _) = order.arrays();
    x.rb_mut().par_col_chunks_mut(width).zip(scratch).for_each(|(mut x, Scratch { rows, below })| {
        rows.resize(width * x.nrows(), 0.0);
        for (c, column) in x.rb().col_iter().enumerate() {
            for (row, from) in rows.chunks_exact_mut(width).zip(to) {
                row[c] = column[*from];
            }
        }
        arch.dispatch(|| match width {
            4 => substitute::<4>(factor, rows, below),
            8 => substitute::<8>(factor, rows, below),
            12 => substitute::<12>(factor, rows, below),
            _ => substitute::<MOST>(factor, rows, below),
        });
        for (c, column) in x.rb_mut().col_iter_mut().enumerate() {
            let mut column = column;
            for (row, from) in rows.chunks_exact(width).zip(to) {
                column[*from] = row[c];
            }
        }
    });
}

/// Replaces rows x by (L Lᵀ)⁻¹ x.
#[inline(always)]
fn substitute<const W: usize>(factor: SupernodalLltRef<'_, usize, f64>, rows: &mut [f64], below: &mut Vec<f64>) {
    let (rows, _) = rows.as_chunks_mut::<W>();
    let count = factor.symbolic().n_supernodes();
    for s in 0..count {
        let supernode = Supernode::new(factor, s);
        let below = supernode.gather(rows, below);
        supernode.forward(&mut rows[supernode.start..][..supernode.width], below);
        for (row, below) in supernode.pattern.iter().zip(below) {
            rows[*row] = *below;
        }
    }
    for s in (0..count).rev() {
        let supernode = Supernode::new(factor, s);
        let below = supernode.gather(rows, below);
        supernode.backward(&mut rows[supernode.start..][..supernode.width], below);
    }
}

/// Columns of L with the same rows below them.
struct Supernode<'a> {
    start: usize,
    width: usize,
    /// The rows below.
    pattern: &'a [usize],
    /// Its columns one after the other, each with its own rows, then those below.
    values: &'a [f64],
}

impl<'a> Supernode<'a> {
    #[inline(always)]
    fn new(factor: SupernodalLltRef<'a, usize, f64>, s: usize) -> Self {
        let symbolic = factor.symbolic();
        let (start, end) = (symbolic.supernode_begin()[s], symbolic.supernode_end()[s]);
        let range = symbolic.col_ptr_for_val()[s]..symbolic.col_ptr_for_val()[s + 1];
        let pattern = symbolic.supernode(s).pattern();
        Self { start, width: end - start, pattern, values: &factor.values()[range] }
    }

    /// The rows below.
    #[inline(always)]
    fn gather<'b, const W: usize>(&self, rows: &[[f64; W]], below: &'b mut Vec<f64>) -> &'b mut [[f64; W]] {
        below.resize(below.len().max(W * self.pattern.len()), 0.0);
        let (below, _) = below[..W * self.pattern.len()].as_chunks_mut::<W>();
        for (below, row) in below.iter_mut().zip(self.pattern) {
            *below = rows[*row];
        }
        below
    }

    /// The rows of a column from `first` on, own ones and those below.
    #[inline(always)]
    fn column(&self, column: usize, first: usize) -> (&'a [f64], &'a [f64]) {
        let rows = self.width + self.pattern.len();
        let (own, below) = self.values[column * rows..(column + 1) * rows].split_at(self.width);
        (&own[first..], below)
    }

    /// x ← L⁻¹ x in the own rows, and what that takes from the rows below.
    #[inline(always)]
    fn forward<const W: usize>(&self, own: &mut [[f64; W]], below: &mut [[f64; W]]) {
        let whole = self.width - self.width % COLUMNS;
        for first in (0..whole).step_by(COLUMNS) {
            self.forward_columns::<COLUMNS, W>(first, own, below);
        }
        for first in whole..self.width {
            self.forward_columns::<1, W>(first, own, below);
        }
    }

    #[inline(always)]
    fn forward_columns<const K: usize, const W: usize>(
        &self,
        first: usize,
        own: &mut [[f64; W]],
        below: &mut [[f64; W]],
    ) {
        let (here, after) = own[first..].split_at_mut(K);
        let mut x = [[0.0; W]; K];
        for k in 0..K {
            let (column, _) = self.column(first + k, first);
            for x in &mut here[k] {
                *x /= column[k];
            }
            x[k] = here[k];
            for i in k + 1..K {
                for c in 0..W {
                    here[i][c] -= column[i] * x[k][c];
                }
            }
        }
        let (columns_own, columns_below) = self.columns::<K>(first);
        take_products(after, columns_own, &x);
        take_products(below, columns_below, &x);
    }

    /// x ← L⁻ᵀ x in the own rows, where the rows below are known.
    #[inline(always)]
    fn backward<const W: usize>(&self, own: &mut [[f64; W]], below: &[[f64; W]]) {
        let whole = self.width - self.width % COLUMNS;
        for first in (whole..self.width).rev() {
            self.backward_columns::<1, W>(first, own, below);
        }
        for first in (0..whole).step_by(COLUMNS).rev() {
            self.backward_columns::<COLUMNS, W>(first, own, below);
        }
    }

    #[inline(always)]
    fn backward_columns<const K: usize, const W: usize>(&self, first: usize, own: &mut [[f64; W]], below: &[[f64; W]]) {
        let (here, after) = own[first..].split_at_mut(K);
        let (columns_own, columns_below) = self.columns::<K>(first);
        let mut sums = [[0.0; W]; K];
        add_products(&mut sums, columns_own, after);
        add_products(&mut sums, columns_below, below);
        for k in (0..K).rev() {
            let (column, _) = self.column(first + k, first);
            for c in 0..W {
                let mut x = here[k][c] - sums[k][c];
                for i in k + 1..K {
                    x -= column[i] * here[i][c];
                }
                here[k][c] = x / column[k];
            }
        }
    }

    /// K columns from `first` on, without their rows on the diagonal block: the own rows after it, and those below.
    #[inline(always)]
    fn columns<const K: usize>(&self, first: usize) -> ([&'a [f64]; K], [&'a [f64]; K]) {
        let mut found: ([&[f64]; K], [&[f64]; K]) = ([&[]; K], [&[]; K]);
        for k in 0..K {
            (found.0[k], found.1[k]) = self.column(first + k, first + K);
        }
        found
    }
}

/// rows −= columns · x.
#[inline(always)]
fn take_products<const K: usize, const W: usize>(rows: &mut [[f64; W]], columns: [&[f64]; K], x: &[[f64; W]; K]) {
    let columns = columns.map(|column| &column[..rows.len()]);
    for i in 0..rows.len() {
        let mut row = rows[i];
        for k in 0..K {
            for c in 0..W {
                row[c] -= columns[k][i] * x[k][c];
            }
        }
        rows[i] = row;
    }
}

/// sums += columnsᵀ · rows.
#[inline(always)]
fn add_products<const K: usize, const W: usize>(sums: &mut [[f64; W]; K], columns: [&[f64]; K], rows: &[[f64; W]]) {
    let columns = columns.map(|column| &column[..rows.len()]);
    let mut found = *sums;
    for (i, row) in rows.iter().enumerate() {
        for k in 0..K {
            for c in 0..W {
                found[k][c] += columns[k][i] * row[c];
            }
        }
    }
    *sums = found;
}

#[cfg(test)]
mod tests {
    use faer::dyn_stack::{MemBuffer, MemStack};
    use faer::sparse::linalg::cholesky::{
        CholeskySymbolicParams, LltRef, SymbolicCholeskyRaw, SymmetricOrdering, factorize_symbolic_cholesky,
    };
    use faer::sparse::linalg::{SupernodalThreshold, SymbolicSupernodalParams};
    use faer::sparse::{SparseColMat, Triplet};
    use faer::{Conj, Mat, Par, Side, Spec};

    use super::*;

    /// A grid of `side`³ nodes, each coupled to its neighbours.
    fn grid(side: usize) -> SparseColMat<usize, f64> {
        let n = side.pow(3);
        let place = |i: usize| [i % side, i / side % side, i / side.pow(2)];
        let near = |i: usize, j: usize| (0..3).all(|axis| place(i)[axis].abs_diff(place(j)[axis]) <= 1);
        let entry = |i: usize, j: usize| if i == j { 30.0 } else { -1.0 + 1e-3 * ((i * j) as f64).sin() };
        let pairs = (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).filter(|(i, j)| near(*i, *j));
        let entries: Vec<_> = pairs.map(|(i, j)| Triplet::new(i, j, entry(i.min(j), i.max(j)))).collect();
        SparseColMat::try_new_from_triplets(n, n, &entries).unwrap()
    }

    #[test]
    fn it_gives_what_faer_gives_for_any_number_of_columns_and_threads() {
        let a = grid(9);
        let n = a.ncols();
        let params = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            supernodal_params: SymbolicSupernodalParams { relax: None },
            ..CholeskySymbolicParams::default()
        };
        let symbolic = factorize_symbolic_cholesky(a.symbolic(), Side::Lower, SymmetricOrdering::Amd, params).unwrap();
        let SymbolicCholeskyRaw::Supernodal(supernodal) = symbolic.raw() else { panic!() };
        let mut values = vec![0.0; symbolic.len_val()];
        let needed = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Spec::default());
        let mut scratch = MemBuffer::new(needed);
        let stack = MemStack::new(&mut scratch);
        let factor = symbolic.factorize_numeric_llt(
            &mut values,
            a.as_ref(),
            Side::Lower,
            Default::default(),
            Par::Seq,
            stack,
            Spec::default(),
        );
        factor.unwrap();
        let widths =
            (0..supernodal.n_supernodes()).map(|s| supernodal.supernode_end()[s] - supernodal.supernode_begin()[s]);
        assert!(widths.clone().any(|width| width > COLUMNS) && widths.clone().any(|width| width < COLUMNS));
        for columns in [1, 3, 8, 10, 17, 40] {
            let b = Mat::from_fn(n, columns, |i, j| ((i * 7 + j * 13) as f64).cos());
            let mut expected = b.clone();
            let mut scratch = MemBuffer::new(symbolic.solve_in_place_scratch::<f64>(columns, Par::Seq));
            let stack = MemStack::new(&mut scratch);
            LltRef::new(&symbolic, &values).solve_in_place_with_conj(Conj::No, expected.as_mut(), Par::Seq, stack);
            let on_threads = |threads: usize| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let mut x = b.clone();
                let factor = SupernodalLltRef::new(supernodal, &values);
                pool.install(|| solve(factor, symbolic.perm().unwrap(), x.as_mut(), &mut Vec::new()));
                x
            };
            let (one, three) = (on_threads(1), on_threads(3));
            assert_eq!(one, three);
            assert!((&one - &expected).norm_max() < 1e-14 && (&a * &one - &b).norm_max() < 1e-13);
        }
    }
}
