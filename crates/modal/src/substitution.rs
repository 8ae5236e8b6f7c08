//! Forward and backward substitution with a supernodal factor, `L Lᵀ = P A Pᵀ`, for several vectors at once.
//!
//! The numbers of a row lie side by side. So the factor, which is far larger than the processor's cache, is read once for
//! all vectors of a group, and a row of them is one run of memory wherever it is.

use std::ops::Range;

use faer::MatMut;
use faer::perm::PermRef;
use faer::reborrow::{Reborrow, ReborrowMut};
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use crate::factor_layout::{COLUMNS, NODE, Passes, STRIP, of_own_rows, passes};
use crate::packed_rows::{add_multiple, prefetch, scale, subtract};
use crate::subtrees::Subtrees;
use crate::supernodes::Supernodes;

/// Vectors of a group at the most.
const MOST: usize = 16;
/// Vectors of a group are a multiple of this, which is filled up.
const STEP: usize = 4;
/// Rows that are put into the order of the factor in one task.
const ROWS: usize = 4096;
/// Numbers of the factor that are asked for ahead of their use.
const AHEAD: usize = 384;

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

/// A factor with supernodes, [interleaved](crate::interleave), and its parts.
#[derive(Clone, Copy)]
pub(crate) struct Factor<'a> {
    pub supernodes: &'a Supernodes,
    pub subtrees: &'a Subtrees,
    pub values: &'a [f64],
}

/// Replaces `x` (N×k) by A⁻¹ x. The result does not depend on the number of threads.
pub(crate) fn solve(factor: Factor<'_>, order: PermRef<'_, usize>, mut x: MatMut<'_, f64>, scratch: &mut Scratch) {
    let groups = x.ncols().div_ceil(MOST);
    let width = x.ncols().div_ceil(groups.max(1)).next_multiple_of(STEP).max(STEP);
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
            4 => factor.solve::<4>(scratch),
            8 => factor.solve::<8>(scratch),
            12 => factor.solve::<12>(scratch),
            _ => factor.solve::<MOST>(scratch),
        }
        let rows = &scratch.rows;
        x.rb_mut().par_row_chunks_mut(ROWS).zip(new.par_chunks(ROWS)).for_each(|(x, new)| {
            for (x, new) in x.row_iter_mut().zip(new) {
                x.iter_mut().zip(&rows[width * new..]).for_each(|(to, from)| *to = *from);
            }
        });
    }
}

impl Factor<'_> {
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
            arch.dispatch(Forward { factor: self, part, outside, below: &mut scratch.below });
        });
        let of_top = |s: &usize| self.supernodes.columns(*s);
        for row in top.iter().flat_map(of_top) {
            let sum = &mut rows_of_top[place[row] as usize];
            *sum = rows[row];
            for part in &*of_parts {
                let added = &part.outside[W * place[row] as usize..][..W];
                sum.iter_mut().zip(added).for_each(|(sum, added)| *sum += added);
            }
        }
        arch.dispatch(Top { factor: self, rows: rows_of_top, below: top_below });
        for row in top.iter().flat_map(of_top) {
            rows[row] = rows_of_top[place[row] as usize];
        }
        let rows_of_top = &*rows_of_top;
        self.split(rows).into_par_iter().zip(of_parts).for_each(|(part, scratch)| {
            arch.dispatch(Backward { factor: self, part, top: rows_of_top, below: &mut scratch.below });
        });
    }

    /// The parts, each with its own rows.
    fn split<'b, const W: usize>(&self, rows: &'b mut [[f64; W]]) -> Vec<Part<'b, W>> {
        let part =
            |(supernodes, range, rows): (Range<usize>, Range<usize>, _)| Part { supernodes, first: range.start, rows };
        self.subtrees.split(rows, |part| self.supernodes.columns_of(part)).into_iter().map(part).collect()
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
    factor: Factor<'a>,
    part: Part<'a, W>,
    outside: &'a mut [[f64; W]],
    below: &'a mut Vec<f64>,
}

impl<const W: usize> WithSimd for Forward<'_, W> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { factor, part: Part { supernodes, first, rows }, outside, below } = self;
        let place = &factor.subtrees.place;
        for s in supernodes {
            let supernode = Supernode::new(factor, s);
            let taken = supernode.forward(simd, &mut rows[supernode.start - first..][..supernode.width], below);
            supernode.take(simd, taken, rows, first, outside, place);
        }
    }
}

/// Forward and backward through the top.
struct Top<'a, const W: usize> {
    factor: Factor<'a>,
    rows: &'a mut [[f64; W]],
    below: &'a mut Vec<f64>,
}

impl<const W: usize> WithSimd for Top<'_, W> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { factor, rows, below } = self;
        let Subtrees { top, place, .. } = factor.subtrees;
        let own = |supernode: &Supernode<'_>| {
            let first = place[supernode.start] as usize;
            first..first + supernode.width
        };
        for s in top {
            let supernode = Supernode::new(factor, *s);
            let taken = supernode.forward(simd, &mut rows[own(&supernode)], below);
            supernode.take(simd, taken, &mut [], 0, rows, place);
        }
        for s in top.iter().rev() {
            let supernode = Supernode::new(factor, *s);
            let minus_below = supernode.gather(&[], 0, rows, place, below);
            supernode.backward(simd, &mut rows[own(&supernode)], minus_below);
        }
    }
}

/// Backward through a part, where the rows of the top are known.
struct Backward<'a, const W: usize> {
    factor: Factor<'a>,
    part: Part<'a, W>,
    top: &'a [[f64; W]],
    below: &'a mut Vec<f64>,
}

impl<const W: usize> WithSimd for Backward<'_, W> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { factor, part: Part { supernodes, first, rows }, top, below } = self;
        let place = &factor.subtrees.place;
        for s in supernodes.rev() {
            let supernode = Supernode::new(factor, s);
            let minus_below = supernode.gather(rows, first, top, place, below);
            supernode.backward(simd, &mut rows[supernode.start - first..][..supernode.width], minus_below);
        }
    }
}

/// Columns of L with the same rows below them.
struct Supernode<'a> {
    start: usize,
    width: usize,
    /// The rows below.
    pattern: &'a [u32],
    /// The numbers of the own rows.
    own: &'a [f64],
    /// Those of the rows below, by strips.
    below: &'a [f64],
}

impl<'a> Supernode<'a> {
    #[inline(always)]
    fn new(factor: Factor<'a>, s: usize) -> Self {
        let supernodes = factor.supernodes;
        let (start, width) = (supernodes.columns(s).start, supernodes.width(s));
        let (own, below) = factor.values[supernodes.entries(s)].split_at(of_own_rows(width));
        Self { start, width, pattern: supernodes.below(s), own, below }
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
        for (below, row) in below.iter_mut().zip(self.pattern.iter().map(|row| *row as usize)) {
            let row = match rows.get(row - first) {
                Some(row) => row,
                None => &top[place[row] as usize],
            };
            *below = row.map(|x| -x);
        }
        below
    }

    /// Subtracts from the rows below.
    #[inline(always)]
    fn take<const W: usize, S: Simd>(
        &self,
        simd: S,
        taken: &[[f64; W]],
        rows: &mut [[f64; W]],
        first: usize,
        top: &mut [[f64; W]],
        place: &[u32],
    ) {
        for (taken, row) in taken.iter().zip(self.pattern.iter().map(|row| *row as usize)) {
            let row = match rows.get_mut(row - first) {
                Some(row) => row,
                None => &mut top[place[row] as usize],
            };
            subtract(simd, row, taken);
        }
    }

    /// Strips of the rows below, with the number of the first row of each.
    #[inline(always)]
    fn strips(&self) -> impl DoubleEndedIterator<Item = (usize, Strip<'a>)> {
        let Self { width, below, pattern, .. } = *self;
        let rows = pattern.len();
        (0..rows).step_by(STRIP).map(move |first| {
            let count = STRIP.min(rows - first);
            (first, Strip { rows: count, values: &below[width * first..width * (first + count)] })
        })
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
        let mut diagonal = self.own;
        forward::<COLUMNS, W, S>(simd, &mut diagonal, most.clone(), own);
        forward::<NODE, W, S>(simd, &mut diagonal, nodes.clone(), own);
        forward::<1, W, S>(simd, &mut diagonal, single.clone(), own);
        for (first, strip) in self.strips() {
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
        // From the last number to the first: one run of memory, as the way forward.
        for (first, strip) in self.strips().rev() {
            let rows = &minus_below[first..][..strip.rows];
            strip.add_to_columns::<1, W, S>(simd, single.clone(), rows, own);
            strip.add_to_columns::<NODE, W, S>(simd, nodes.clone(), rows, own);
            strip.add_to_columns::<COLUMNS, W, S>(simd, most.clone(), rows, own);
        }
        let mut diagonal = self.own;
        backward::<1, W, S>(simd, &mut diagonal, single, own);
        backward::<NODE, W, S>(simd, &mut diagonal, nodes, own);
        backward::<COLUMNS, W, S>(simd, &mut diagonal, most, own);
    }
}

/// Some of the rows below a supernode.
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
        for first in passes.rev() {
            if let Some((x, _)) = x[first..].split_first_chunk_mut::<K>() {
                add_products(simd, x, self.columns(first), rows);
            }
        }
    }
}

/// x ← L⁻¹ x in own rows by passes over K columns, whose numbers are the first of `numbers`; leaves the rest there.
#[inline(always)]
fn forward<const K: usize, const W: usize, S: Simd>(simd: S, numbers: &mut &[f64], passes: Passes, x: &mut [[f64; W]]) {
    for first in passes {
        let (of_pass, rest) = numbers.split_at(K * (x.len() - first));
        *numbers = rest;
        let (here, after) = x[first..].split_at_mut(K);
        let (diagonal, columns) = of_pass.as_chunks::<K>().0.split_at(K);
        let mut minus_x = [[0.0; W]; K];
        for k in 0..K {
            let (known, unknown) = here.split_at_mut(k + 1);
            scale(simd, &mut known[k], 1.0 / diagonal[k][k]);
            minus_x[k] = known[k].map(|x| -x);
            for (x, row) in unknown.iter_mut().zip(&diagonal[k + 1..]) {
                add_multiple(simd, x, row[k], &minus_x[k]);
            }
        }
        add_combinations(simd, after, columns, &minus_x);
    }
}

/// x ← L⁻ᵀ x in own rows by passes over K columns, the last first, whose numbers are the last of `numbers`; leaves the rest there.
#[inline(always)]
fn backward<const K: usize, const W: usize, S: Simd>(
    simd: S,
    numbers: &mut &[f64],
    passes: Passes,
    x: &mut [[f64; W]],
) {
    for first in passes.rev() {
        let (rest, of_pass) = numbers.split_at(numbers.len() - K * (x.len() - first));
        *numbers = rest;
        let (here, after) = x[first..].split_at_mut(K);
        let (diagonal, columns) = of_pass.as_chunks::<K>().0.split_at(K);
        let mut sums = [[0.0; W]; K];
        add_products(simd, &mut sums, columns, after);
        for k in (0..K).rev() {
            let (unknown, known) = here.split_at_mut(k + 1);
            for (x, row) in known.iter().zip(&diagonal[k + 1..]) {
                add_multiple(simd, &mut sums[k], row[k], x);
            }
            subtract(simd, &mut unknown[k], &sums[k]);
            scale(simd, &mut unknown[k], 1.0 / diagonal[k][k]);
        }
    }
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
    let whole = W / S::F64_LANES;
    for v in (0..whole - whole % 2).step_by(2) {
        let x: [[S::f64s; 2]; K] = std::array::from_fn(|k| [parts[k].0[v], parts[k].0[v + 1]]);
        for (row, factors) in rows.iter_mut().zip(columns) {
            if v == 0 {
                prefetch(factors.as_ptr().wrapping_add(AHEAD));
            }
            let row = S::as_mut_simd_f64s(row).0;
            // Sums of their own: in the row, each addition would be written to memory.
            let (mut one, mut two) = (row[v], row[v + 1]);
            for k in 0..K {
                let factor = simd.splat_f64s(factors[k]);
                one = simd.mul_add_e_f64s(factor, x[k][0], one);
                two = simd.mul_add_e_f64s(factor, x[k][1], two);
            }
            (row[v], row[v + 1]) = (one, two);
        }
    }
    if whole % 2 == 1 {
        let x: [S::f64s; K] = std::array::from_fn(|k| parts[k].0[whole - 1]);
        for (row, factors) in rows.iter_mut().zip(columns) {
            let row = &mut S::as_mut_simd_f64s(row).0[whole - 1];
            let mut sum = *row;
            for k in 0..K {
                sum = simd.mul_add_e_f64s(simd.splat_f64s(factors[k]), x[k], sum);
            }
            *row = sum;
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
    for (row, factors) in rows.iter().zip(columns).rev() {
        prefetch(factors.as_ptr().wrapping_sub(AHEAD));
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
    use crate::factor_layout::tests::of_faer;
    use crate::interleave::interleave;

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
        ordered(a, SymmetricOrdering::Amd)
    }

    /// The same in the order of the matrix.
    pub(crate) fn supernodal_in_order(a: &SparseColMat<usize, f64>) -> SymbolicCholesky<usize> {
        ordered(a, SymmetricOrdering::Identity)
    }

    fn ordered(a: &SparseColMat<usize, f64>, order: SymmetricOrdering<'_, usize>) -> SymbolicCholesky<usize> {
        let params = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            supernodal_params: SymbolicSupernodalParams { relax: None },
            ..CholeskySymbolicParams::default()
        };
        factorize_symbolic_cholesky(a.symbolic(), Side::Lower, order, params).unwrap()
    }

    #[test]
    fn it_gives_what_faer_gives_for_any_number_of_columns_and_threads() {
        let a = grid(18);
        let n = a.ncols();
        let symbolic = supernodal(&a);
        let SymbolicCholeskyRaw::Supernodal(supernodal) = symbolic.raw() else { panic!() };
        let supernodes = Supernodes::new(supernodal, 1);
        let subtrees = Subtrees::new(&supernodes);
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
        let mut interleaved = of_faer(supernodal, &values);
        interleave(&supernodes, &subtrees, &mut interleaved);
        let widths = (0..supernodes.count()).map(|s| supernodes.width(s));
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
                let factor = Factor { supernodes: &supernodes, subtrees: &subtrees, values: &interleaved };
                let order = symbolic.perm().unwrap();
                pool.install(|| solve(factor, order, x.as_mut(), &mut Scratch::default()));
                x
            };
            let (one, three) = (on_threads(1), on_threads(3));
            assert_eq!(one, three);
            assert!((&one - &expected).norm_max() < 1e-14 && (&a * &one - &b).norm_max() < 1e-13);
        }
    }
}
