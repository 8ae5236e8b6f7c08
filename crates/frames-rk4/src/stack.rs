//! Products of several square matrices of one size with one list, side by side.
//!
//! ```text
//! rows of four:   A_1 x … A_K x of the first four rows, then of the next
//! entries:        for each four rows, for each column, for each matrix: four numbers
//! ```
//!
//! So the matrices are read from end to end, and the sums of four rows of all of them stay in registers.

use faer::Mat;
use pulp::Simd;

use crate::four::{Four, Group, WIDTH};
use crate::side_by_side::Lists;

/// Columns that are gone through in a turn.
const TURN: usize = 2;

/// K square matrices of one size.
#[derive(Debug, Clone)]
pub(crate) struct Stack {
    count: usize,
    size: usize,
    /// Columns with those of zeros that fill the last turn.
    columns: usize,
    /// In one column, which begins at the start of a line of the cache, so that no vector lies across two.
    entries: Mat<f64>,
}

/// Where products go: in lists of `width` groups for each four rows, from the group `first` on.
pub(crate) struct Places<'a> {
    pub groups: &'a mut [Group],
    pub width: usize,
    pub first: usize,
}

impl Stack {
    /// The sizes are all the same.
    pub(crate) fn new(matrices: &[Mat<f64>]) -> Self {
        let (count, size) = (matrices.len(), matrices.first().map_or(0, Mat::nrows));
        let columns = size.next_multiple_of(TURN);
        let entry = |k: usize, i: usize, j: usize| if i < size && j < size { matrices[k][(i, j)] } else { 0.0 };
        let mut entries = Vec::with_capacity(size.next_multiple_of(WIDTH) * columns * count);
        for first in (0..size).step_by(WIDTH) {
            for j in 0..columns {
                for k in 0..count {
                    entries.extend((first..first + WIDTH).map(|i| entry(k, i, j)));
                }
            }
        }
        Self { count, size, columns, entries: Mat::from_fn(entries.len(), 1, |k, _| entries[k]) }
    }

    /// Numbers of the matrices themselves.
    pub(crate) fn len(&self) -> usize {
        self.count * self.size * self.size
    }

    fn groups(&self) -> &[Group] {
        if self.entries.ncols() > 0 { self.entries.col_as_slice(0).as_chunks().0 } else { &[] }
    }

    /// `start` + A_k x, with K lists to start from. x is a list in groups.
    #[inline(always)]
    pub(crate) fn multiply<S: Simd>(&self, simd: S, x: &[Group], start: Lists<'_>, out: Places<'_>) {
        match self.count {
            0 => {}
            1 => self.products::<S, 1>(simd, x, start, out),
            2 => self.products::<S, 2>(simd, x, start, out),
            3 => self.products::<S, 3>(simd, x, start, out),
            6 => self.products::<S, 6>(simd, x, start, out),
            _ => self.products::<S, 9>(simd, x, start, out),
        }
    }

    #[inline(always)]
    fn products<S: Simd, const K: usize>(&self, simd: S, x: &[Group], start: Lists<'_>, out: Places<'_>) {
        let x = &x.as_flattened()[..self.columns];
        let (entries, _) = self.groups().as_chunks::<K>();
        let mut start = start.rows();
        let mut rows = entries.chunks_exact(self.columns.max(1)).zip(out.groups.chunks_exact_mut(out.width));
        // Few sums do not keep the processor busy: those of twice as many rows at once.
        while K < 4 && rows.len() > 1 {
            let (Some((a, out_a)), Some((b, out_b))) = (rows.next(), rows.next()) else { return };
            let mut sums: [[Four<S>; K]; 2] = [sums_from(simd, start.next()), sums_from(simd, start.next())];
            for ((a, b), x) in a.iter().zip(b).zip(x) {
                let x = Four::splat(simd, *x);
                for k in 0..K {
                    sums[0][k] = Four::load(simd, &a[k]).mul_add(simd, x, sums[0][k]);
                    sums[1][k] = Four::load(simd, &b[k]).mul_add(simd, x, sums[1][k]);
                }
            }
            store_all(&sums[0], &mut out_a[out.first..]);
            store_all(&sums[1], &mut out_b[out.first..]);
        }
        let (x, _) = x.as_chunks::<TURN>();
        for (entries, groups) in rows {
            let mut sums: [Four<S>; K] = sums_from(simd, start.next());
            for (entries, x) in entries.as_chunks::<TURN>().0.iter().zip(x) {
                for turn in 0..TURN {
                    let x = Four::splat(simd, x[turn]);
                    for k in 0..K {
                        sums[k] = Four::load(simd, &entries[turn][k]).mul_add(simd, x, sums[k]);
                    }
                }
            }
            store_all(&sums, &mut groups[out.first..]);
        }
    }

    /// The same of x, and then A_k y of the matrices that do not belong to pairs: these are read once for both lists.
    #[inline(always)]
    pub(crate) fn multiply_two<S: Simd>(&self, simd: S, [x, y]: [&[Group]; 2], start: &[Group], out: &mut [Group]) {
        match self.count {
            0 => {}
            2 => self.two_products::<S, 2, 1, 3>(simd, [x, y], start, out),
            _ => self.two_products::<S, 9, 3, 12>(simd, [x, y], start, out),
        }
    }

    #[inline(always)]
    fn two_products<S: Simd, const K: usize, const L: usize, const BOTH: usize>(
        &self,
        simd: S,
        [x, y]: [&[Group]; 2],
        start: &[Group],
        out: &mut [Group],
    ) {
        let [x, y] = [&x.as_flattened()[..self.columns], &y.as_flattened()[..self.columns]];
        let ((x, _), (y, _)) = (x.as_chunks::<TURN>(), y.as_chunks::<TURN>());
        let (entries, _) = self.groups().as_chunks::<K>();
        let rows = entries.chunks_exact(self.columns.max(1)).zip(start.as_chunks::<K>().0);
        for ((entries, start), out) in rows.zip(out.as_chunks_mut::<BOTH>().0) {
            let mut sums: [Four<S>; K] = sums_from(simd, Some(start));
            let mut second = [Four::splat(simd, 0.0); L];
            for ((entries, x), y) in entries.as_chunks::<TURN>().0.iter().zip(x).zip(y) {
                for turn in 0..TURN {
                    let (x, y) = (Four::splat(simd, x[turn]), Four::splat(simd, y[turn]));
                    for k in 0..L {
                        let entry = Four::load(simd, &entries[turn][k]);
                        sums[k] = entry.mul_add(simd, x, sums[k]);
                        second[k] = entry.mul_add(simd, y, second[k]);
                    }
                    for k in L..K {
                        sums[k] = Four::load(simd, &entries[turn][k]).mul_add(simd, x, sums[k]);
                    }
                }
            }
            store_all(&sums, out);
            store_all(&second, &mut out[K..]);
        }
    }
}

/// Sums that begin with these numbers, or with zeros.
#[inline(always)]
fn sums_from<S: Simd, const K: usize>(simd: S, start: Option<&[Group]>) -> [Four<S>; K] {
    let mut sums = [Four::splat(simd, 0.0); K];
    if let Some(start) = start {
        for (sum, start) in sums.iter_mut().zip(start) {
            *sum = Four::load(simd, start);
        }
    }
    sums
}

#[inline(always)]
fn store_all<S: Simd, const K: usize>(all: &[Four<S>; K], groups: &mut [Group]) {
    for (four, group) in all.iter().zip(groups) {
        four.store(group);
    }
}
