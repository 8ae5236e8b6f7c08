//! Forward and backward substitution with a supernodal factor, `L Lᵀ = P A Pᵀ`, for several vectors at once.
//!
//! The numbers of a row lie side by side. So the factor, which is far larger than the processor's cache, is read once for
//! all vectors of a group, and a row of them is one run of memory wherever it is.

use std::ops::Range;

use faer::MatMut;
use faer::perm::PermRef;
use faer::reborrow::{Reborrow, ReborrowMut};
use faer::sparse::linalg::cholesky::supernodal::SupernodalLltRef;
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use crate::subtrees::Subtrees;

/// Vectors of a group at the most.
const MOST: usize = 16;
/// Vectors of a group are a multiple of this, which is filled up.
const STEP: usize = 4;
/// Rows that are put into the order of the factor in one task.
const ROWS: usize = 4096;
/// Columns of the factor that are applied in one pass over the rows below them.
const COLUMNS: usize = 6;
/// Columns of a node with three degrees of freedom.
const NODE: usize = 3;

/// Scratch of [`solve`], which can be used again.
#[derive(Default)]
pub(crate) struct Scratch {
    /// The vectors row by row, in the order of the factor.
    rows: Vec<f64>,
    /// The rows of the top.
    top: Vec<f64>,
    top_below: Vec<f64>,
    parts: Vec<OfPart>,
}

/// Scratch of a part.
#[derive(Default)]
struct OfPart {
    /// What the part adds to the rows of the top.
    outside: Vec<f64>,
    below: Vec<f64>,
}

/// How many numbers [`solve`] takes as scratch for so many rows and columns.
pub(crate) fn scratch(rows: usize, columns: usize) -> usize {
    2 * rows * columns.next_multiple_of(STEP).min(MOST)
}

/// Replaces `x` (N×k) by A⁻¹ x. The result does not depend on the number of threads.
pub(crate) fn solve(
    factor: SupernodalLltRef<'_, usize, f64>,
    subtrees: &Subtrees,
    order: PermRef<'_, usize>,
    mut x: MatMut<'_, f64>,
    scratch: &mut Scratch,
) {
    let groups = x.ncols().div_ceil(MOST);
    let width = x.ncols().div_ceil(groups.max(1)).next_multiple_of(STEP).max(STEP);
    let problem = Problem { factor, subtrees };
    let (to, _) = order.arrays();
    for first in (0..x.ncols()).step_by(width) {
        let columns = width.min(x.ncols() - first);
        let x = x.rb_mut().subcols_mut(first, columns);
        scratch.rows.resize(width * x.nrows(), 0.0);
        scratch.rows.par_chunks_mut(width * ROWS).zip(to.par_chunks(ROWS)).for_each(|(rows, to)| {
            for (c, column) in x.rb().col_iter().enumerate() {
                for (row, from) in rows.chunks_exact_mut(width).zip(to) {
                    row[c] = column[*from];
                }
            }
        });
        match width {
            4 => problem.solve::<4>(scratch),
            8 => problem.solve::<8>(scratch),
            12 => problem.solve::<12>(scratch),
            _ => problem.solve::<MOST>(scratch),
        }
        let rows = &scratch.rows;
        x.par_col_chunks_mut(1).enumerate().for_each(|(c, mut column)| {
            for (row, from) in rows.chunks_exact(width).zip(to) {
                column[(*from, 0)] = row[c];
            }
        });
    }
}

/// A factor and its parts.
#[derive(Clone, Copy)]
struct Problem<'a> {
    factor: SupernodalLltRef<'a, usize, f64>,
    subtrees: &'a Subtrees,
}

impl Problem<'_> {
    /// Replaces rows x by (L Lᵀ)⁻¹ x: forward through the parts side by side, through the top and back, and backward
    /// through the parts.
    fn solve<const W: usize>(self, scratch: &mut Scratch) {
        let arch = Arch::new();
        let Subtrees { parts, top, place, top_rows } = self.subtrees;
        let Scratch { rows, top: rows_of_top, top_below, parts: of_parts } = scratch;
        let (rows, _) = rows.as_chunks_mut::<W>();
        rows_of_top.resize(W * top_rows, 0.0);
        let (rows_of_top, _) = rows_of_top.as_chunks_mut::<W>();
        of_parts.resize_with(parts.len().max(of_parts.len()), OfPart::default);
        let of_parts = &mut of_parts[..parts.len()];

        self.split(rows).into_par_iter().zip(&mut *of_parts).for_each(|(part, scratch)| {
            scratch.outside.clear();
            scratch.outside.resize(W * top_rows, 0.0);
            let (outside, _) = scratch.outside.as_chunks_mut();
            arch.dispatch(Forward { problem: self, part, outside, below: &mut scratch.below });
        });
        let of_top =
            |s: &usize| self.factor.symbolic().supernode_begin()[*s]..self.factor.symbolic().supernode_end()[*s];
        for row in top.iter().flat_map(of_top) {
            let sum = &mut rows_of_top[place[row] as usize];
            *sum = rows[row];
            for part in &*of_parts {
                let added = &part.outside[W * place[row] as usize..][..W];
                sum.iter_mut().zip(added).for_each(|(sum, added)| *sum += added);
            }
        }
        arch.dispatch(Top { problem: self, rows: rows_of_top, below: top_below });
        for row in top.iter().flat_map(of_top) {
            rows[row] = rows_of_top[place[row] as usize];
        }
        let rows_of_top = &*rows_of_top;
        self.split(rows).into_par_iter().zip(of_parts).for_each(|(part, scratch)| {
            arch.dispatch(Backward { problem: self, part, top: rows_of_top, below: &mut scratch.below });
        });
    }

    /// The parts, each with its own rows.
    fn split<'b, const W: usize>(&self, rows: &'b mut [[f64; W]]) -> Vec<Part<'b, W>> {
        let symbolic = self.factor.symbolic();
        let of_part =
            |part: &Range<usize>| symbolic.supernode_begin()[part.start]..symbolic.supernode_end()[part.end - 1];
        let part =
            |(supernodes, range, rows): (Range<usize>, Range<usize>, _)| Part { supernodes, first: range.start, rows };
        self.subtrees.split(rows, of_part).into_iter().map(part).collect()
    }
}

/// A run of supernodes, and its rows.
struct Part<'a, const W: usize> {
    supernodes: Range<usize>,
    /// The number of its first row.
    first: usize,
    rows: &'a mut [[f64; W]],
}

/// Forward through a part: x ← L⁻¹ x in its rows, and what that takes from the rows of the top. A type rather than a closure:
/// what a closure calls is compiled without the vector instructions.
struct Forward<'a, const W: usize> {
    problem: Problem<'a>,
    part: Part<'a, W>,
    outside: &'a mut [[f64; W]],
    below: &'a mut Vec<f64>,
}

impl<const W: usize> WithSimd for Forward<'_, W> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) {
        let Self { problem: Problem { factor, subtrees }, part: Part { supernodes, first, rows }, outside, below } =
            self;
        for s in supernodes {
            let supernode = Supernode::new(factor, s);
            let below = supernode.gather(rows, first, outside, &subtrees.place, below);
            supernode.forward::<W, S>(&mut rows[supernode.start - first..][..supernode.width], below);
            supernode.scatter(below, rows, first, outside, &subtrees.place);
        }
    }
}

/// Forward and backward through the top.
struct Top<'a, const W: usize> {
    problem: Problem<'a>,
    rows: &'a mut [[f64; W]],
    below: &'a mut Vec<f64>,
}

impl<const W: usize> WithSimd for Top<'_, W> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) {
        let Self { problem: Problem { factor, subtrees }, rows, below } = self;
        let place = &subtrees.place;
        let own = |supernode: &Supernode<'_>| {
            let first = place[supernode.start] as usize;
            first..first + supernode.width
        };
        for s in &subtrees.top {
            let supernode = Supernode::new(factor, *s);
            let below = supernode.gather(&[], 0, rows, place, below);
            supernode.forward::<W, S>(&mut rows[own(&supernode)], below);
            supernode.scatter(below, &mut [], 0, rows, place);
        }
        for s in subtrees.top.iter().rev() {
            let supernode = Supernode::new(factor, *s);
            let below = supernode.gather(&[], 0, rows, place, below);
            supernode.backward::<W, S>(&mut rows[own(&supernode)], below);
        }
    }
}

/// Backward through a part, where the rows of the top are known.
struct Backward<'a, const W: usize> {
    problem: Problem<'a>,
    part: Part<'a, W>,
    top: &'a [[f64; W]],
    below: &'a mut Vec<f64>,
}

impl<const W: usize> WithSimd for Backward<'_, W> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) {
        let Self { problem: Problem { factor, subtrees }, part: Part { supernodes, first, rows }, top, below } = self;
        for s in supernodes.rev() {
            let supernode = Supernode::new(factor, s);
            let below = supernode.gather(rows, first, top, &subtrees.place, below);
            supernode.backward::<W, S>(&mut rows[supernode.start - first..][..supernode.width], below);
        }
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

    /// The rows below: first those among `rows`, which begin with row `first`, then those of the top.
    #[inline(always)]
    fn gather<'b, const W: usize>(
        &self,
        rows: &[[f64; W]],
        first: usize,
        top: &[[f64; W]],
        place: &[u32],
        below: &'b mut Vec<f64>,
    ) -> &'b mut [[f64; W]] {
        below.resize(below.len().max(W * self.pattern.len()), 0.0);
        let (below, _) = below[..W * self.pattern.len()].as_chunks_mut();
        let (within, beyond) = self.parted(first + rows.len());
        for (below, row) in below.iter_mut().zip(within) {
            *below = rows[row - first];
        }
        for (below, row) in below[within.len()..].iter_mut().zip(beyond) {
            *below = top[place[*row] as usize];
        }
        below
    }

    /// Puts the rows below back to where they were gathered.
    #[inline(always)]
    fn scatter<const W: usize>(
        &self,
        below: &[[f64; W]],
        rows: &mut [[f64; W]],
        first: usize,
        top: &mut [[f64; W]],
        place: &[u32],
    ) {
        let (within, beyond) = self.parted(first + rows.len());
        for (below, row) in below.iter().zip(within) {
            rows[row - first] = *below;
        }
        for (below, row) in below[within.len()..].iter().zip(beyond) {
            top[place[*row] as usize] = *below;
        }
    }

    /// The rows below that come before a row, and the others.
    #[inline(always)]
    fn parted(&self, row: usize) -> (&'a [usize], &'a [usize]) {
        self.pattern.split_at(self.pattern.partition_point(|other| *other < row))
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
    fn forward<const W: usize, S: Simd>(&self, own: &mut [[f64; W]], below: &mut [[f64; W]]) {
        let mut first = 0;
        while first < self.width {
            first += match self.width - first {
                COLUMNS.. => self.forward_columns::<COLUMNS, W, S>(first, own, below),
                NODE.. => self.forward_columns::<NODE, W, S>(first, own, below),
                _ => self.forward_columns::<1, W, S>(first, own, below),
            };
        }
    }

    #[inline(always)]
    fn forward_columns<const K: usize, const W: usize, S: Simd>(
        &self,
        first: usize,
        own: &mut [[f64; W]],
        below: &mut [[f64; W]],
    ) -> usize {
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
        take_products::<K, W, S>(after, columns_own, &x);
        take_products::<K, W, S>(below, columns_below, &x);
        K
    }

    /// x ← L⁻ᵀ x in the own rows, where the rows below are known.
    #[inline(always)]
    fn backward<const W: usize, S: Simd>(&self, own: &mut [[f64; W]], below: &[[f64; W]]) {
        let mut end = self.width;
        while end > 0 {
            end -= match end {
                COLUMNS.. => self.backward_columns::<COLUMNS, W, S>(end - COLUMNS, own, below),
                NODE.. => self.backward_columns::<NODE, W, S>(end - NODE, own, below),
                _ => self.backward_columns::<1, W, S>(end - 1, own, below),
            };
        }
    }

    #[inline(always)]
    fn backward_columns<const K: usize, const W: usize, S: Simd>(
        &self,
        first: usize,
        own: &mut [[f64; W]],
        below: &[[f64; W]],
    ) -> usize {
        let (here, after) = own[first..].split_at_mut(K);
        let (columns_own, columns_below) = self.columns::<K>(first);
        let mut sums = [[0.0; W]; K];
        add_products::<K, W, S>(&mut sums, columns_own, after);
        add_products::<K, W, S>(&mut sums, columns_below, below);
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
        K
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
fn take_products<const K: usize, const W: usize, S: Simd>(
    rows: &mut [[f64; W]],
    columns: [&[f64]; K],
    x: &[[f64; W]; K],
) {
    let columns = columns.map(|column| &column[..rows.len()]);
    for i in 0..rows.len() {
        let mut row = rows[i];
        for k in 0..K {
            for c in 0..W {
                row[c] = multiply_add::<S>(-columns[k][i], x[k][c], row[c]);
            }
        }
        rows[i] = row;
    }
}

/// sums += columnsᵀ · rows.
#[inline(always)]
fn add_products<const K: usize, const W: usize, S: Simd>(
    sums: &mut [[f64; W]; K],
    columns: [&[f64]; K],
    rows: &[[f64; W]],
) {
    let columns = columns.map(|column| &column[..rows.len()]);
    let mut found = *sums;
    for (i, row) in rows.iter().enumerate() {
        for k in 0..K {
            for c in 0..W {
                found[k][c] = multiply_add::<S>(columns[k][i], row[c], found[k][c]);
            }
        }
    }
    *sums = found;
}

/// a·b + c, in one instruction where the processor has it.
#[inline(always)]
fn multiply_add<S: Simd>(a: f64, b: f64, c: f64) -> f64 {
    if S::F64_LANES > 1 { a.mul_add(b, c) } else { a * b + c }
}

#[cfg(test)]
pub(crate) mod tests {
    use faer::dyn_stack::{MemBuffer, MemStack};
    use faer::sparse::linalg::cholesky::{
        CholeskySymbolicParams, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
        factorize_symbolic_cholesky,
    };
    use faer::sparse::linalg::{SupernodalThreshold, SymbolicSupernodalParams};
    use faer::sparse::{SparseColMat, Triplet};
    use faer::{Conj, Mat, Par, Side, Spec};

    use super::*;

    /// A grid of `side`³ nodes, each coupled to its neighbours.
    pub(crate) fn grid(side: usize) -> SparseColMat<usize, f64> {
        let n = side.pow(3);
        let place = |i: usize| [i % side, i / side % side, i / side.pow(2)];
        let near = |i: usize, j: usize| (0..3).all(|axis| place(i)[axis].abs_diff(place(j)[axis]) <= 1);
        let entry = |i: usize, j: usize| if i == j { 30.0 } else { -1.0 + 1e-3 * ((i * j) as f64).sin() };
        let pairs = (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).filter(|(i, j)| near(*i, *j));
        let entries: Vec<_> = pairs.map(|(i, j)| Triplet::new(i, j, entry(i.min(j), i.max(j)))).collect();
        SparseColMat::try_new_from_triplets(n, n, &entries).unwrap()
    }

    /// The pattern of the factor of a matrix, by supernodes.
    pub(crate) fn supernodal(a: &SparseColMat<usize, f64>) -> SymbolicCholesky<usize> {
        let params = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            supernodal_params: SymbolicSupernodalParams { relax: None },
            ..CholeskySymbolicParams::default()
        };
        factorize_symbolic_cholesky(a.symbolic(), Side::Lower, SymmetricOrdering::Amd, params).unwrap()
    }

    #[test]
    fn it_gives_what_faer_gives_for_any_number_of_columns_and_threads() {
        let a = grid(18);
        let n = a.ncols();
        let symbolic = supernodal(&a);
        let SymbolicCholeskyRaw::Supernodal(supernodal) = symbolic.raw() else { panic!() };
        let subtrees = Subtrees::new(supernodal);
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
        assert!(subtrees.parts.len() > 3 && !subtrees.top.is_empty());
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
                let order = symbolic.perm().unwrap();
                pool.install(|| solve(factor, &subtrees, order, x.as_mut(), &mut Scratch::default()));
                x
            };
            let (one, three) = (on_threads(1), on_threads(3));
            assert_eq!(one, three);
            assert!((&one - &expected).norm_max() < 1e-14 && (&a * &one - &b).norm_max() < 1e-13);
        }
    }
}
