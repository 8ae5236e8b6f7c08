//! The numeric Cholesky factorisation of K + sM by supernodes, `L Lᵀ = P A Pᵀ`, on all threads.
//!
//! Left-looking, as in CHOLMOD (Chen, Davis, Hager, Rajamanickam 2008): a supernode takes its columns of A, subtracts what
//! the supernodes before it give to them, and is factored as a dense matrix. The subtrees of the elimination tree are done
//! side by side, then the supernodes above them, each by strips of rows. The numbers do not depend on the number of threads.

use faer::dyn_stack::{MemBuffer, MemStack};
use std::ops::Range;

use faer::linalg::cholesky::llt::factor::{LltError, cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::perm::PermRef;
use faer::reborrow::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, MatRef, Par, Spec};
use rayon::prelude::*;

use crate::factor::layout::{of_own_rows, write_own_rows};
use crate::factor::shifted_matrix::ShiftedMatrix;
use crate::factor::subtrees::Subtrees;
use crate::factor::supernodes::Supernodes;
use crate::matrix::row_chunks::row_chunks_mut;

/// Rows that one task updates. Fixed, so that the numbers are.
const STRIP: usize = 256;
/// No supernode.
const NONE: u32 = u32::MAX;

/// A pivot that is not positive: its place in the order of the factor.
pub(crate) struct NotPositive(pub usize);

/// A matrix to factor, and its pattern.
pub(crate) struct Problem<'a> {
    pub supernodes: &'a Supernodes,
    pub subtrees: &'a Subtrees,
    pub order: PermRef<'a, usize>,
    pub matrix: &'a ShiftedMatrix<'a>,
}

/// Bytes that [`Problem::factor`] takes as scratch on `threads` threads, without what products of dense matrices take.
pub(crate) fn scratch_bytes(supernodes: &Supernodes, threads: usize) -> usize {
    let widest = (0..supernodes.count()).map(|s| supernodes.width(s)).max().unwrap_or(0);
    4 * (supernodes.unknowns() + 3 * supernodes.count()) * (threads + 1) + 8 * widest * (STRIP * threads + widest)
}

impl Problem<'_> {
    /// Fills the zeros in `values` with the entries of L, the rows below a supernode column by column.
    pub(crate) fn factor(&self, values: &mut [f64]) -> Result<(), NotPositive> {
        let of_row = self.supernodes.of_columns();
        let given: Vec<Vec<Given>> = self
            .subtrees
            .split(values, |part| self.supernodes.entries_of(part))
            .into_par_iter()
            .map_init(
                || Work::new(self.supernodes),
                |work, (part, range, values)| {
                    part.clone().try_for_each(|s| self.supernode(s, range.start, values, &of_row, work))?;
                    Ok(work.queue.clear(part))
                },
            )
            .collect::<Result<_, _>>()?;
        let mut work = Work::new(self.supernodes);
        for given in given.iter().flatten() {
            let row = self.supernodes.below(given.by)[given.from];
            work.queue.push(of_row[row as usize], *given);
        }
        for s in &self.subtrees.top {
            self.supernode(*s, 0, values, &of_row, &mut work)?;
        }
        Ok(())
    }

    /// Makes the columns of a supernode. `values` has those of all that give to it, from the entry `base` of the factor on.
    fn supernode(
        &self,
        s: usize,
        base: usize,
        values: &mut [f64],
        of_row: &[u32],
        work: &mut Work,
    ) -> Result<(), NotPositive> {
        let Work { place, queue, updates, sums, own, dense } = work;
        let Range { start, end } = self.supernodes.columns(s);
        let pattern = self.supernodes.below(s);
        let width = end - start;
        for (i, row) in (start..end).chain(pattern.iter().map(|row| *row as usize)).enumerate() {
            place[row] = i as u32;
        }
        let range = self.supernodes.entries(s);
        let (before, values) = values.split_at_mut(range.start - base);
        let (packed, below) = values[..range.len()].split_at_mut(of_own_rows(width));
        own.clear();
        own.resize(width * width, 0.0);
        let (old, new) = self.order.arrays();
        for (column, own) in own.chunks_exact_mut(width).enumerate() {
            let below = &mut below[column * pattern.len()..][..pattern.len()];
            self.matrix.add_column(old[start + column], |row, run| {
                // The rows of a node stay together. Above the diagonal nothing is read.
                if new[row] + run.len() > start + column {
                    let place = place[new[row]] as usize;
                    let rows = if place < width { &mut own[place..] } else { &mut below[place - width..] };
                    rows.iter_mut().zip(run).for_each(|(sum, value)| *sum += value);
                }
            });
        }

        queue.take(s, updates);
        for update in &mut *updates {
            let pattern = self.supernodes.below(update.by);
            let next = update.from + pattern[update.from..].partition_point(|row| (*row as usize) < end);
            if next < pattern.len() {
                queue.push(of_row[pattern[next] as usize], Given { by: update.by, from: next });
            }
        }
        if let Some(row) = pattern.first() {
            queue.push(of_row[*row as usize], Given { by: s, from: 0 });
        }

        let before = Before { problem: self, values: before, base, place, updates, end };
        let mut diagonal = MatMut::from_column_major_slice_mut(own, width, width);
        let mut below = MatMut::from_column_major_slice_mut(below, pattern.len(), width);
        let alone = !self.subtrees.is_parted();
        for (rows, first) in [(diagonal.rb_mut(), 0), (below.rb_mut(), width)] {
            if alone || rows.nrows() <= STRIP {
                before.subtract(rows, first, sums);
            } else {
                row_chunks_mut(rows, STRIP).enumerate().for_each_init(Sums::default, |sums, (strip, rows)| {
                    before.subtract(rows, first + STRIP * strip, sums);
                });
            }
        }

        dense.grow(width);
        let stack = MemStack::new(&mut dense.0);
        cholesky_in_place(diagonal.rb_mut(), Default::default(), Par::Seq, stack, Spec::default())
            .map_err(|LltError::NonPositivePivot { index }| NotPositive(start + index))?;
        let diagonal = diagonal.rb();
        let solve = |below: MatMut<'_, f64>| solve_lower_triangular_in_place(diagonal, below.transpose_mut(), Par::Seq);
        if alone || below.nrows() <= STRIP {
            solve(below);
        } else {
            row_chunks_mut(below, STRIP).for_each(solve);
        }
        write_own_rows(width, own, packed);
        Ok(())
    }
}

/// The contribution of a supernode to later ones, from one of the rows below it on.
#[derive(Clone, Copy)]
struct Given {
    by: usize,
    from: usize,
}

/// Which supernodes give to which next: lists that share two arrays.
struct Queue {
    /// The first that gives to a supernode.
    head: Vec<u32>,
    /// The one after a supernode in its list.
    next: Vec<u32>,
    /// The supernode that one gives to next.
    target: Vec<u32>,
    /// The row of its pattern from which on it does.
    from: Vec<u32>,
}

impl Queue {
    fn push(&mut self, to: u32, given: Given) {
        self.next[given.by] = self.head[to as usize];
        self.head[to as usize] = given.by as u32;
        self.target[given.by] = to;
        self.from[given.by] = given.from as u32;
    }

    /// Empties all lists; what is in them is given by some supernodes.
    fn clear(&mut self, by: Range<usize>) -> Vec<Given> {
        let mut all = Vec::new();
        for by in by {
            let target = std::mem::replace(&mut self.target[by], NONE);
            if target != NONE {
                self.head[target as usize] = NONE;
                all.push(Given { by, from: self.from[by] as usize });
            }
        }
        all
    }

    /// Empties the list of a supernode.
    fn take(&mut self, s: usize, list: &mut Vec<Given>) {
        list.clear();
        let mut by = std::mem::replace(&mut self.head[s], NONE);
        while by != NONE {
            self.target[by as usize] = NONE;
            list.push(Given { by: by as usize, from: self.from[by as usize] as usize });
            by = self.next[by as usize];
        }
    }
}

/// Scratch of a thread.
struct Work {
    /// The place of each row in the supernode at hand.
    place: Vec<u32>,
    queue: Queue,
    updates: Vec<Given>,
    sums: Sums,
    /// The own rows of the supernode at hand, column by column.
    own: Vec<f64>,
    dense: Dense,
}

impl Work {
    fn new(supernodes: &Supernodes) -> Self {
        let none = || vec![NONE; supernodes.count()];
        Self {
            place: vec![0; supernodes.unknowns()],
            queue: Queue { head: none(), next: none(), target: none(), from: none() },
            updates: Vec::new(),
            sums: Sums::default(),
            own: Vec::new(),
            dense: Dense(MemBuffer::new(cholesky_in_place_scratch::<f64>(1, Par::Seq, Spec::default())), 1),
        }
    }
}

/// Scratch of a dense factorisation, and its number of rows.
struct Dense(MemBuffer, usize);

impl Dense {
    fn grow(&mut self, rows: usize) {
        if rows > self.1 {
            *self = Self(MemBuffer::new(cholesky_in_place_scratch::<f64>(rows, Par::Seq, Spec::default())), rows);
        }
    }
}

/// Scratch of an update.
#[derive(Default)]
struct Sums {
    products: Vec<f64>,
    runs: Vec<Run>,
}

/// Rows of an update that are neighbours in the supernode at hand, too.
struct Run {
    first: usize,
    place: usize,
    rows: usize,
}

/// Cuts rows with these places into runs.
fn cut(places: impl Iterator<Item = usize>, runs: &mut Vec<Run>) {
    runs.clear();
    for (row, place) in places.enumerate() {
        match runs.last_mut() {
            Some(last) if last.place + last.rows == place => last.rows += 1,
            _ => runs.push(Run { first: row, place, rows: 1 }),
        }
    }
}

/// The supernodes that give to the one at hand, which ends before the row `end`.
struct Before<'a> {
    problem: &'a Problem<'a>,
    values: &'a [f64],
    base: usize,
    place: &'a [u32],
    updates: &'a [Given],
    end: usize,
}

impl Before<'_> {
    /// Takes from rows of the supernode at hand, `own` from the row `first` on, what the others give to them.
    fn subtract(&self, mut own: MatMut<'_, f64>, first: usize, sums: &mut Sums) {
        let Sums { products, runs } = sums;
        let Problem { supernodes, .. } = self.problem;
        for given in self.updates {
            let pattern = supernodes.below(given.by);
            let height = pattern.len();
            let pattern = &pattern[given.from..];
            let place = |row: u32| self.place[row as usize] as usize;
            let below = |row: usize| pattern.partition_point(|other| place(*other) < row);
            let (low, high) = (below(first), below(first + own.nrows()));
            if low == high {
                continue;
            }
            // Entries above the diagonal are left out as far as that is for nothing.
            let columns = pattern.partition_point(|row| (*row as usize) < self.end).min(high);
            let (width, range) = (supernodes.width(given.by), supernodes.entries(given.by));
            let of_it = &self.values[range.start + of_own_rows(width) - self.base..range.end - self.base];
            let of_it = MatRef::from_column_major_slice(of_it, height, width).subrows(given.from, pattern.len());

            cut(pattern[low..high].iter().map(|row| place(*row) - first), runs);
            products.resize(products.len().max((high - low) * columns), 0.0);
            let products = &mut products[..(high - low) * columns];
            matmul(
                MatMut::from_column_major_slice_mut(products, high - low, columns),
                Accum::Replace,
                of_it.subrows(low, high - low),
                of_it.subrows(0, columns).transpose(),
                1.0,
                Par::Seq,
            );
            for (products, row) in products.chunks_exact(high - low).zip(pattern) {
                let mut own = own.rb_mut().col_mut(place(*row));
                for Run { first, place, rows } in &*runs {
                    let own = own.rb_mut().subrows_mut(*place, *rows);
                    own.iter_mut().zip(&products[*first..first + rows]).for_each(|(own, product)| *own -= product);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use faer::Side;
    use faer::sparse::linalg::cholesky::SymbolicCholeskyRaw;
    use faer::sparse::{SparseColMat, Triplet};

    use super::*;
    use crate::factor::layout::tests::of_faer;
    use crate::factor::substitution::tests::{grid, supernodal};
    use crate::matrix::mass_matrix::MassMatrix;
    use crate::support::constraints::Constraints;
    use crate::support::held::Support;

    /// The factor of A + shift·1 by this module on one thread and on three, and by faer.
    fn factors(a: &SparseColMat<usize, f64>, shift: f64) -> [Option<Vec<f64>>; 3] {
        let n = a.ncols();
        let ones: Vec<_> = (0..n).map(|i| Triplet::new(i, i, 1.0)).collect();
        let ones = SparseColMat::try_new_from_triplets(n, n, &ones).unwrap();
        let positions: Vec<[f64; 3]> = (0..n / 3).map(|i| [i as f64, (i * i % 7) as f64, (i % 5) as f64]).collect();
        let constraints = Constraints::new(&Support::free(), &positions, 3).unwrap();
        let ones = MassMatrix::new(ones.as_ref(), n / 3).unwrap();
        let matrix = ShiftedMatrix::new(a.as_ref().into(), &ones, shift, &constraints);
        let assembled = matrix.assembled(&matrix.pattern().unwrap()).unwrap();
        let symbolic = supernodal(&assembled);
        let SymbolicCholeskyRaw::Supernodal(factor) = symbolic.raw() else { panic!() };
        let supernodes = Supernodes::new(factor, 1);
        let subtrees = Subtrees::new(&supernodes);
        assert!(subtrees.parts.len() > 3 && !subtrees.top.is_empty());

        let order = symbolic.perm().unwrap();
        let problem = Problem { supernodes: &supernodes, subtrees: &subtrees, order, matrix: &matrix };
        let on = |threads: usize| {
            let mut values = vec![0.0; supernodes.factor_entries()];
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| problem.factor(&mut values)).ok().map(|()| values)
        };
        let mut values = vec![0.0; symbolic.len_val()];
        let (side, par, spec) = (Side::Lower, Par::Seq, Spec::default());
        let mut scratch = MemBuffer::new(symbolic.factorize_numeric_llt_scratch::<f64>(par, spec));
        let stack = MemStack::new(&mut scratch);
        let spec = Spec::default();
        let by_faer =
            symbolic.factorize_numeric_llt(&mut values, assembled.as_ref(), side, Default::default(), par, stack, spec);
        let is_definite = by_faer.is_ok();
        [on(1), on(3), is_definite.then(|| of_faer(factor, &values))]
    }

    /// Independent reference: the factor by faer.
    #[test]
    fn the_factor_is_that_of_faer_and_the_same_on_any_number_of_threads() {
        let [one, three, expected] = factors(&grid(18), 2.0).map(Option::unwrap);
        assert_eq!(one, three);
        assert!(one.iter().zip(&expected).all(|(l, expected)| (l - expected).abs() < 1e-13));
    }

    /// Independent reference: faer has no factor either.
    #[test]
    fn a_matrix_that_is_not_definite_has_no_factor() {
        assert!(factors(&grid(18), -25.0).iter().all(Option::is_none));
    }
}
