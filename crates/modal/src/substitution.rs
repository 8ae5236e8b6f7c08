//! Forward and backward substitution with a supernodal factor, `L Lᵀ = P A Pᵀ`, for several vectors at once.
//!
//! The numbers of a row lie side by side. So the factor, which is far larger than the processor's cache, is read once for
//! all vectors of a group, and a row of them is one run of memory wherever it is.

use std::iter::StepBy;
use std::ops::Range;

use faer::MatMut;
use faer::perm::PermRef;
use faer::reborrow::{Reborrow, ReborrowMut};
use faer::sparse::linalg::cholesky::supernodal::{SupernodalLltRef, SymbolicSupernodalCholesky};
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
/// Rows below a supernode that are taken together: they stay in the processor's first cache.
const STRIP: usize = 128;
/// Numbers of the factor that are asked for ahead of their use.
const AHEAD: usize = 384;
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

/// Replaces `x` (N×k) by A⁻¹ x, where the factor is [interleaved](interleave). The result does not depend on the number of threads.
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
    let (old, new) = order.arrays();
    for first in (0..x.ncols()).step_by(width) {
        let columns = width.min(x.ncols() - first);
        let mut x = x.rb_mut().subcols_mut(first, columns);
        scratch.rows.resize(width * x.nrows(), 0.0);
        scratch.rows.par_chunks_mut(width * ROWS).zip(old.par_chunks(ROWS)).for_each(|(rows, old)| {
            for (row, old) in rows.chunks_exact_mut(width).zip(old) {
                row.iter_mut().zip(x.rb().row(*old).iter()).for_each(|(to, from)| *to = *from);
            }
        });
        match width {
            4 => problem.solve::<4>(scratch),
            8 => problem.solve::<8>(scratch),
            12 => problem.solve::<12>(scratch),
            _ => problem.solve::<MOST>(scratch),
        }
        let rows = &scratch.rows;
        x.rb_mut().par_row_chunks_mut(ROWS).zip(new.par_chunks(ROWS)).for_each(|(x, new)| {
            for (x, new) in x.row_iter_mut().zip(new) {
                x.iter_mut().zip(&rows[width * new..]).for_each(|(to, from)| *to = *from);
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
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { problem: Problem { factor, subtrees }, part: Part { supernodes, first, rows }, outside, below } =
            self;
        for s in supernodes {
            let supernode = Supernode::new(factor, s);
            let taken = supernode.forward(simd, &mut rows[supernode.start - first..][..supernode.width], below);
            supernode.take(taken, rows, first, outside, &subtrees.place);
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
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { problem: Problem { factor, subtrees }, rows, below } = self;
        let place = &subtrees.place;
        let own = |supernode: &Supernode<'_>| {
            let first = place[supernode.start] as usize;
            first..first + supernode.width
        };
        for s in &subtrees.top {
            let supernode = Supernode::new(factor, *s);
            let taken = supernode.forward(simd, &mut rows[own(&supernode)], below);
            supernode.take(taken, &mut [], 0, rows, place);
        }
        for s in subtrees.top.iter().rev() {
            let supernode = Supernode::new(factor, *s);
            let minus_below = supernode.gather(&[], 0, rows, place, below);
            supernode.backward(simd, &mut rows[own(&supernode)], minus_below);
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
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { problem: Problem { factor, subtrees }, part: Part { supernodes, first, rows }, top, below } = self;
        for s in supernodes.rev() {
            let supernode = Supernode::new(factor, s);
            let minus_below = supernode.gather(rows, first, top, &subtrees.place, below);
            supernode.backward(simd, &mut rows[supernode.start - first..][..supernode.width], minus_below);
        }
    }
}

/// Columns of L with the same rows below them.
struct Supernode<'a> {
    start: usize,
    width: usize,
    /// The rows below.
    pattern: &'a [usize],
    /// Its columns in the order of [`interleave`], with the own rows, then those below.
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

    /// Room for the rows below.
    #[inline(always)]
    fn below<'b, const W: usize>(&self, scratch: &'b mut Vec<f64>) -> &'b mut [[f64; W]] {
        scratch.resize(scratch.len().max(W * self.pattern.len()), 0.0);
        scratch[..W * self.pattern.len()].as_chunks_mut().0
    }

    /// The negative of the rows below: first those among `rows`, which begin with row `first`, then those of the top.
    #[inline(always)]
    fn gather<'b, const W: usize>(
        &self,
        rows: &[[f64; W]],
        first: usize,
        top: &[[f64; W]],
        place: &[u32],
        scratch: &'b mut Vec<f64>,
    ) -> &'b [[f64; W]] {
        let below = self.below(scratch);
        let (within, beyond) = self.parted(first + rows.len());
        for (below, row) in below.iter_mut().zip(within) {
            *below = rows[row - first].map(|x| -x);
        }
        for (below, row) in below[within.len()..].iter_mut().zip(beyond) {
            *below = top[place[*row] as usize].map(|x| -x);
        }
        below
    }

    /// Subtracts from the rows below.
    #[inline(always)]
    fn take<const W: usize>(
        &self,
        taken: &[[f64; W]],
        rows: &mut [[f64; W]],
        first: usize,
        top: &mut [[f64; W]],
        place: &[u32],
    ) {
        let (within, beyond) = self.parted(first + rows.len());
        for (taken, row) in taken.iter().zip(within) {
            rows[row - first].iter_mut().zip(taken).for_each(|(x, taken)| *x -= taken);
        }
        for (taken, row) in taken[within.len()..].iter().zip(beyond) {
            top[place[*row] as usize].iter_mut().zip(taken).for_each(|(x, taken)| *x -= taken);
        }
    }

    /// The rows below that come before a row, and the others.
    #[inline(always)]
    fn parted(&self, row: usize) -> (&'a [usize], &'a [usize]) {
        self.pattern.split_at(self.pattern.partition_point(|other| *other < row))
    }

    /// The numbers of the own rows, then strips of those below with the number of their first row.
    #[inline(always)]
    fn strips(&self) -> (Strip<'a>, impl Iterator<Item = (usize, Strip<'a>)>) {
        let Self { width, values, .. } = *self;
        let rows = self.pattern.len();
        let (own, below) = values.split_at(width * width);
        let strip = move |first: usize| {
            let count = STRIP.min(rows - first);
            (first, Strip { rows: count, values: &below[width * first..width * (first + count)] })
        };
        (Strip { rows: width, values: own }, (0..rows).step_by(STRIP).map(strip))
    }

    /// x ← L⁻¹ x in the own rows; returns what that takes from the rows below.
    #[inline(always)]
    fn forward<'b, const W: usize, S: Simd>(
        &self,
        simd: S,
        own: &mut [[f64; W]],
        scratch: &'b mut Vec<f64>,
    ) -> &'b [[f64; W]] {
        let taken = self.below(scratch);
        taken.fill([0.0; W]);
        let [most, nodes, single] = passes(self.width);
        let (diagonal, strips) = self.strips();
        diagonal.forward::<COLUMNS, W, S>(simd, most.clone(), own);
        diagonal.forward::<NODE, W, S>(simd, nodes.clone(), own);
        diagonal.forward::<1, W, S>(simd, single.clone(), own);
        for (first, strip) in strips {
            let taken = &mut taken[first..][..strip.rows];
            strip.add_to_rows::<COLUMNS, W, S>(simd, most.clone(), own, taken);
            strip.add_to_rows::<NODE, W, S>(simd, nodes.clone(), own, taken);
            strip.add_to_rows::<1, W, S>(simd, single.clone(), own, taken);
        }
        taken
    }

    /// x ← L⁻ᵀ x in the own rows, where the rows below are known.
    #[inline(always)]
    fn backward<const W: usize, S: Simd>(&self, simd: S, own: &mut [[f64; W]], minus_below: &[[f64; W]]) {
        let [most, nodes, single] = passes(self.width);
        let (diagonal, strips) = self.strips();
        for (first, strip) in strips {
            let rows = &minus_below[first..][..strip.rows];
            strip.add_to_columns::<COLUMNS, W, S>(simd, most.clone(), rows, own);
            strip.add_to_columns::<NODE, W, S>(simd, nodes.clone(), rows, own);
            strip.add_to_columns::<1, W, S>(simd, single.clone(), rows, own);
        }
        diagonal.backward::<1, W, S>(simd, single, own);
        diagonal.backward::<NODE, W, S>(simd, nodes, own);
        diagonal.backward::<COLUMNS, W, S>(simd, most, own);
    }
}

/// Some rows of a supernode, in the order of [`interleave`].
#[derive(Clone, Copy)]
struct Strip<'a> {
    rows: usize,
    values: &'a [f64],
}

impl<'a> Strip<'a> {
    /// K columns from `first` on, row by row.
    #[inline(always)]
    fn columns<const K: usize>(&self, first: usize) -> &'a [[f64; K]] {
        self.values[first * self.rows..(first + K) * self.rows].as_chunks().0
    }

    /// Of the rows on the diagonal: x ← L⁻¹ x by passes over K columns.
    #[inline(always)]
    fn forward<const K: usize, const W: usize, S: Simd>(&self, simd: S, passes: Passes, x: &mut [[f64; W]]) {
        for first in passes {
            let (here, after) = x[first..].split_at_mut(K);
            let (diagonal, columns) = self.columns::<K>(first)[first..].split_at(K);
            let mut minus_x = [[0.0; W]; K];
            for k in 0..K {
                for x in &mut here[k] {
                    *x /= diagonal[k][k];
                }
                minus_x[k] = here[k].map(|x| -x);
                for i in k + 1..K {
                    for c in 0..W {
                        here[i][c] += diagonal[i][k] * minus_x[k][c];
                    }
                }
            }
            add_combinations(simd, after, columns, &minus_x);
        }
    }

    /// Of the rows on the diagonal: x ← L⁻ᵀ x by passes over K columns, the last first.
    #[inline(always)]
    fn backward<const K: usize, const W: usize, S: Simd>(&self, simd: S, passes: Passes, x: &mut [[f64; W]]) {
        for first in passes.rev() {
            let (here, after) = x[first..].split_at_mut(K);
            let (diagonal, columns) = self.columns::<K>(first)[first..].split_at(K);
            let mut sums = [[0.0; W]; K];
            add_products(simd, &mut sums, columns, after);
            for k in (0..K).rev() {
                for c in 0..W {
                    let mut x = here[k][c] - sums[k][c];
                    for i in k + 1..K {
                        x -= diagonal[i][k] * here[i][c];
                    }
                    here[k][c] = x / diagonal[k][k];
                }
            }
        }
    }

    /// rows += columns · x.
    #[inline(always)]
    fn add_to_rows<const K: usize, const W: usize, S: Simd>(
        &self,
        simd: S,
        passes: Passes,
        x: &[[f64; W]],
        rows: &mut [[f64; W]],
    ) {
        for first in passes {
            if let Some((x, _)) = x[first..].split_first_chunk::<K>() {
                add_combinations(simd, rows, self.columns(first), x);
            }
        }
    }

    /// x += columnsᵀ · rows.
    #[inline(always)]
    fn add_to_columns<const K: usize, const W: usize, S: Simd>(
        &self,
        simd: S,
        passes: Passes,
        rows: &[[f64; W]],
        x: &mut [[f64; W]],
    ) {
        for first in passes {
            if let Some((x, _)) = x[first..].split_first_chunk_mut::<K>() {
                add_products(simd, x, self.columns(first), rows);
            }
        }
    }
}

/// The first columns of the passes over a supernode.
type Passes = StepBy<Range<usize>>;

/// The passes over [`COLUMNS`], over [`NODE`] and over single columns.
#[inline(always)]
fn passes(width: usize) -> [Passes; 3] {
    let of_most = width - width % COLUMNS;
    let of_nodes = width - (width - of_most) % NODE;
    [(0..of_most).step_by(COLUMNS), (of_most..of_nodes).step_by(NODE), (of_nodes..width).step_by(1)]
}

/// Puts the numbers of a factor, which stand column by column in each supernode, into the order in which they are read: the
/// own rows, then strips of the rows below; in each the columns of a pass after those of another, row by row. So a solution
/// reads the factor as one run of memory.
pub(crate) fn interleave(symbolic: &SymbolicSupernodalCholesky<usize>, subtrees: &Subtrees, values: &mut [f64]) {
    let starts = symbolic.col_ptr_for_val();
    let supernode = |s: usize, values: &mut [f64], scratch: &mut Vec<f64>| {
        scratch.clear();
        scratch.extend_from_slice(values);
        let width = symbolic.supernode_end()[s] - symbolic.supernode_begin()[s];
        interleave_supernode(width, scratch, values);
    };
    subtrees.split(values, |part| starts[part.start]..starts[part.end]).into_par_iter().for_each_init(
        Vec::new,
        |scratch, (part, range, values)| {
            for s in part {
                supernode(s, &mut values[starts[s] - range.start..starts[s + 1] - range.start], scratch);
            }
        },
    );
    let mut scratch = Vec::new();
    for s in &subtrees.top {
        supernode(*s, &mut values[starts[*s]..starts[*s + 1]], &mut scratch);
    }
}

/// Writes the columns `from` in the new order.
fn interleave_supernode(width: usize, from: &[f64], mut to: &mut [f64]) {
    let rows = from.len() / width;
    let below = (width..rows).step_by(STRIP).map(|first| first..rows.min(first + STRIP));
    for strip in std::iter::once(0..width).chain(below) {
        let (of_strip, rest) = to.split_at_mut(width * strip.len());
        to = rest;
        let [most, nodes, single] = passes(width);
        interleave_columns::<COLUMNS>(most, from, rows, &strip, of_strip);
        interleave_columns::<NODE>(nodes, from, rows, &strip, of_strip);
        interleave_columns::<1>(single, from, rows, &strip, of_strip);
    }
}

fn interleave_columns<const K: usize>(passes: Passes, from: &[f64], rows: usize, strip: &Range<usize>, to: &mut [f64]) {
    for first in passes {
        let columns: [&[f64]; K] = std::array::from_fn(|k| &from[(first + k) * rows..][strip.clone()]);
        let to = &mut to[first * strip.len()..(first + K) * strip.len()];
        for (i, to) in to.as_chunks_mut::<K>().0.iter_mut().enumerate() {
            *to = std::array::from_fn(|k| columns[k][i]);
        }
    }
}

/// Asks for numbers of the factor that are due soon. The processor does not look as far ahead by itself.
#[inline(always)]
#[expect(unsafe_code, reason = "the instruction of the processor has no safe name")]
fn prefetch<const K: usize>(row: &[f64; K]) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: a hint, which reads nothing: any address will do. All processors of the kind have it.
    unsafe {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        _mm_prefetch::<_MM_HINT_T0>(row.as_ptr().wrapping_add(AHEAD).cast());
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = row;
}

/// rows += columns · x.
#[inline(always)]
fn add_combinations<const K: usize, const W: usize, S: Simd>(
    simd: S,
    rows: &mut [[f64; W]],
    columns: &[[f64; K]],
    x: &[[f64; W]; K],
) {
    let parts = x.each_ref().map(|x| S::as_simd_f64s(x));
    for v in 0..W / S::F64_LANES {
        let x: [S::f64s; K] = std::array::from_fn(|k| parts[k].0[v]);
        for (row, factors) in rows.iter_mut().zip(columns) {
            if v == 0 {
                prefetch(factors);
            }
            let sum = &mut S::as_mut_simd_f64s(row).0[v];
            for k in 0..K {
                *sum = simd.mul_add_e_f64s(simd.splat_f64s(factors[k]), x[k], *sum);
            }
        }
    }
    for (row, factors) in rows.iter_mut().zip(columns) {
        for (c, sum) in S::as_mut_simd_f64s(row).1.iter_mut().enumerate() {
            for k in 0..K {
                *sum += factors[k] * parts[k].1[c];
            }
        }
    }
}

/// sums += columnsᵀ · rows.
#[inline(always)]
fn add_products<const K: usize, const W: usize, S: Simd>(
    simd: S,
    sums: &mut [[f64; W]; K],
    columns: &[[f64; K]],
    rows: &[[f64; W]],
) {
    let mut found = [[simd.splat_f64s(0.0); W]; K];
    for (row, factors) in rows.iter().zip(columns) {
        prefetch(factors);
        let (vectors, rest) = S::as_simd_f64s(row);
        for k in 0..K {
            let factor = simd.splat_f64s(factors[k]);
            for (sum, vector) in found[k].iter_mut().zip(vectors) {
                *sum = simd.mul_add_e_f64s(factor, *vector, *sum);
            }
            for (sum, value) in sums[k][W - rest.len()..].iter_mut().zip(rest) {
                *sum += factors[k] * value;
            }
        }
    }
    for (sums, found) in sums.iter_mut().zip(&found) {
        for (sum, found) in S::as_mut_simd_f64s(sums).0.iter_mut().zip(found) {
            *sum = simd.add_f64s(*sum, *found);
        }
    }
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
        let mut interleaved = values.clone();
        interleave(supernodal, &subtrees, &mut interleaved);
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
                let factor = SupernodalLltRef::new(supernodal, &interleaved);
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
