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

use crate::factor::subtrees::Subtrees;
use crate::factor::supernode::Supernode;
use crate::factor::supernodes::Supernodes;
use crate::matrix::row_chunks::row_chunks_mut;

/// Vectors of a group at the most.
const MOST: usize = 16;
/// Vectors of a group are a multiple of this, which is filled up.
const STEP: usize = 4;
/// Rows that are put into the order of the factor in one task.
const ROWS: usize = 4096;

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
    /// Contribution of the part to the rows of the top.
    outside: Vec<f64>,
    below: Vec<f64>,
}

/// Length of the scratch of [`solve`] for `rows` rows and `columns` columns.
pub(crate) fn scratch(rows: usize, columns: usize) -> usize {
    2 * rows * columns.next_multiple_of(STEP).min(MOST)
}

/// A factor with supernodes, [interleaved](crate::factor::interleave), and its parts.
#[derive(Clone, Copy)]
pub(crate) struct Factor<'a> {
    pub supernodes: &'a Supernodes,
    pub subtrees: &'a Subtrees,
    pub values: &'a [f64],
}

/// Replaces `x` (N×k) by A⁻¹ x; without an order, its rows are in that of the factor. The result does not depend on the number
/// of threads.
pub(crate) fn solve(
    factor: Factor<'_>,
    order: Option<PermRef<'_, usize>>,
    mut x: MatMut<'_, f64>,
    scratch: &mut Scratch,
) {
    let groups = x.ncols().div_ceil(MOST);
    let width = x.ncols().div_ceil(groups.max(1)).next_multiple_of(STEP).max(STEP);
    let order = order.map(PermRef::arrays);
    let old = |row: usize| order.map_or(row, |(old, _)| old[row]);
    let new = |row: usize| order.map_or(row, |(_, new)| new[row]);
    for first in (0..x.ncols()).step_by(width) {
        let columns = width.min(x.ncols() - first);
        let mut x = x.rb_mut().subcols_mut(first, columns);
        scratch.rows.resize(width * x.nrows(), 0.0);
        scratch.rows.par_chunks_mut(width * ROWS).enumerate().for_each(|(task, rows)| {
            for (row, place) in rows.chunks_exact_mut(width).zip(ROWS * task..) {
                row.iter_mut().zip(x.rb().row(old(place)).iter()).for_each(|(to, from)| *to = *from);
            }
        });
        match width {
            4 => factor.solve::<4>(scratch),
            8 => factor.solve::<8>(scratch),
            12 => factor.solve::<12>(scratch),
            _ => factor.solve::<MOST>(scratch),
        }
        let rows = &scratch.rows;
        row_chunks_mut(x.rb_mut(), ROWS).enumerate().for_each(|(task, x)| {
            for (x, row) in x.row_iter_mut().zip(ROWS * task..) {
                x.iter_mut().zip(&rows[width * new(row)..]).for_each(|(to, from)| *to = *from);
            }
        });
    }
}

impl<'a> Factor<'a> {
    #[inline(always)]
    fn supernode(self, s: usize) -> Supernode<'a> {
        Supernode::new(self.supernodes, self.values, s)
    }

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
            let supernode = factor.supernode(s);
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
            let supernode = factor.supernode(*s);
            let taken = supernode.forward(simd, &mut rows[own(&supernode)], below);
            supernode.take(simd, taken, &mut [], 0, rows, place);
        }
        for s in top.iter().rev() {
            let supernode = factor.supernode(*s);
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
            let supernode = factor.supernode(s);
            let minus_below = supernode.gather(rows, first, top, place, below);
            supernode.backward(simd, &mut rows[supernode.start - first..][..supernode.width], minus_below);
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
    use crate::factor::interleave::interleave;
    use crate::factor::layout::COLUMNS;
    use crate::factor::layout::tests::of_faer;

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

    /// Independent reference: the solutions by faer.
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
                pool.install(|| solve(factor, Some(order), x.as_mut(), &mut Scratch::default()));
                x
            };
            let (one, three) = (on_threads(1), on_threads(3));
            assert_eq!(one, three);
            assert!((&one - &expected).norm_max() < 1e-14 && (&a * &one - &b).norm_max() < 1e-13);
        }
    }
}
