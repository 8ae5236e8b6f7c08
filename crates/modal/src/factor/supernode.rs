//! Forward and backward substitution with one supernode of a factor.

use pulp::Simd;

use crate::factor::layout::{COLUMNS, NODE, Passes, STRIP, of_own_rows, passes};
use crate::factor::supernodes::Supernodes;
use crate::matrix::packed_rows::{add_combinations, add_multiple, add_products, scale, subtract};

/// Columns of L with the same rows below them.
pub(crate) struct Supernode<'a> {
    pub start: usize,
    pub width: usize,
    /// The rows below.
    pattern: &'a [u32],
    /// The numbers of the own rows.
    own: &'a [f64],
    /// The numbers of the rows below, by strips.
    below: &'a [f64],
}

impl<'a> Supernode<'a> {
    #[inline(always)]
    pub(crate) fn new(supernodes: &'a Supernodes, values: &'a [f64], s: usize) -> Self {
        let (start, width) = (supernodes.columns(s).start, supernodes.width(s));
        let (own, below) = values[supernodes.entries(s)].split_at(of_own_rows(width));
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
    pub(crate) fn gather<'b, const W: usize>(
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
    pub(crate) fn take<const W: usize, S: Simd>(
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
    pub(crate) fn forward<'b, const W: usize, S: Simd>(
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
    pub(crate) fn backward<const W: usize, S: Simd>(&self, simd: S, own: &mut [[f64; W]], minus_below: &[[f64; W]]) {
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
