//! Products of several square matrices of one size with one list, side by side.
//!
//! ```text
//! rows of four:   A_1 x … A_K x of the first four rows, then of the next
//! entries:        for each four rows, for each column, for each matrix: four numbers
//! ```
//!
//! So the matrices are read from end to end, and the sums of four rows of all of them stay in registers.

use std::sync::Arc;

use faer::Mat;
use pulp::Simd;

use crate::matrix::four::{Four, Group, WIDTH};
use crate::matrix::side_by_side::Lists;

/// Columns that are gone through in a turn.
const TURN: usize = 2;

/// K square matrices of one size.
#[derive(Debug, Clone)]
pub(crate) struct Stack {
    count: usize,
    size: usize,
    /// Columns with those of zeros that fill the last turn.
    columns: usize,
    /// In one column, which begins at the start of a line of the cache, so that no vector lies across two. Equal bodies share it.
    entries: Arc<Mat<f64>>,
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
        let entries = Arc::new(Mat::from_fn(entries.len(), 1, |k, _| entries[k]));
        Self { count, size, columns, entries }
    }

    /// Numbers of the matrices themselves.
    pub(crate) fn len(&self) -> usize {
        self.count * self.size * self.size
    }

    /// Matrix k.
    pub(crate) fn matrix(&self, k: usize) -> Mat<f64> {
        let groups = self.groups();
        let entry = |i: usize, j: usize| groups[(i / WIDTH * self.columns + j) * self.count + k][i % WIDTH];
        Mat::from_fn(self.size, self.size, entry)
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
        let (mut entries, Places { mut groups, width, first }) = (entries, out);
        // Few sums do not keep the processor busy: those of twice as many rows at once.
        while K < 4 && entries.len() > self.columns {
            let (a, rest) = entries.split_at(self.columns);
            let (b, rest) = rest.split_at(self.columns);
            entries = rest;
            let mut sums: [[Four<S>; K]; 2] = [sums_from(simd, start.next()), sums_from(simd, start.next())];
            for ((a, b), x) in a.iter().zip(b).zip(x) {
                let x = Four::splat(simd, *x);
                for k in 0..K {
                    sums[0][k] = Four::load(simd, &a[k]).mul_add(simd, x, sums[0][k]);
                    sums[1][k] = Four::load(simd, &b[k]).mul_add(simd, x, sums[1][k]);
                }
            }
            for sums in &sums {
                store_all(sums, &mut groups[first..]);
                groups = &mut groups[width..];
            }
        }
        let (x, _) = x.as_chunks::<TURN>();
        while let Some((row, rest)) = entries.split_at_checked(self.columns) {
            entries = rest;
            let mut sums: [Four<S>; K] = sums_from(simd, start.next());
            for (entries, x) in row.as_chunks::<TURN>().0.iter().zip(x) {
                for turn in 0..TURN {
                    let x = Four::splat(simd, x[turn]);
                    for k in 0..K {
                        sums[k] = Four::load(simd, &entries[turn][k]).mul_add(simd, x, sums[k]);
                    }
                }
            }
            store_all(&sums, &mut groups[first..]);
            groups = &mut groups[width..];
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
        let (mut entries, _) = self.groups().as_chunks::<K>();
        for (start, out) in start.as_chunks::<K>().0.iter().zip(out.as_chunks_mut::<BOTH>().0) {
            let Some((row, rest)) = entries.split_at_checked(self.columns) else { return };
            entries = rest;
            let mut sums: [Four<S>; K] = sums_from(simd, Some(start));
            let mut second = [Four::splat(simd, 0.0); L];
            for ((entries, x), y) in row.as_chunks::<TURN>().0.iter().zip(x).zip(y) {
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
    // Of known length, so that the sums stay in registers.
    if let Some(start) = start.and_then(|start| start.first_chunk::<K>()) {
        for (sum, start) in sums.iter_mut().zip(start) {
            *sum = Four::load(simd, start);
        }
    }
    sums
}

#[inline(always)]
fn store_all<S: Simd, const K: usize>(all: &[Four<S>; K], groups: &mut [Group]) {
    let Some(groups) = groups.first_chunk_mut::<K>() else { return };
    for (four, group) in all.iter().zip(groups) {
        four.store(group);
    }
}

#[cfg(test)]
mod tests {
    use pulp::{Arch, Scalar, WithSimd};

    use super::*;
    use crate::matrix::four::Padded;
    use crate::matrix::side_by_side::{add_combined, combine, dots, locked_dots, own_products, side_by_side};

    /// Products of `count` matrices, in some vectors.
    struct Products {
        count: usize,
        size: usize,
    }

    impl WithSimd for Products {
        type Output = ();

        #[expect(clippy::needless_range_loop, reason = "lists and rows by their numbers")]
        fn with_simd<S: Simd>(self, simd: S) {
            let Self { count, size } = self;
            let entry = |k: usize, i: usize, j: usize| ((k * 31 + i * 7 + j * 13) as f64).sin();
            let matrices: Vec<_> = (0..count).map(|k| Mat::from_fn(size, size, |i, j| entry(k, i, j))).collect();
            let stack = Stack::new(&matrices);
            assert_eq!(stack.len(), count * size * size);
            (0..count).for_each(|k| assert_eq!(stack.matrix(k), matrices[k]));
            let list = |phase: f64| -> Vec<f64> { (0..size).map(|j| (j as f64 + phase).cos()).collect() };
            let (x, y) = (list(0.1), list(0.7));
            let [x_groups, y_groups] = [&x, &y].map(|list| Padded::from_slice(list));
            let start: Vec<Vec<f64>> = (0..count).map(|k| list(k as f64)).collect();
            let start_groups = side_by_side(&start);
            let expected = |k: usize, i: usize, x: &[f64]| (0..size).map(|j| entry(k, i, j) * x[j]).sum::<f64>();
            let check = |groups: &[Group], width: usize, first: usize, second: usize| {
                let at = |list: usize, i: usize| groups[i / WIDTH * width + list][i % WIDTH];
                for i in 0..size {
                    for k in 0..count {
                        let error = at(first + k, i) - start[k][i] - expected(k, i, &x);
                        assert!(error.abs() < 1e-13, "{count} of size {size}");
                    }
                    for k in 0..second {
                        assert!((at(count + k, i) - expected(k, i, &y)).abs() < 1e-13, "{count} of size {size}");
                    }
                }
            };
            let width = count + 2;
            let mut out = vec![[f64::NAN; WIDTH]; width * size.div_ceil(WIDTH)];
            let lists = Lists { groups: &start_groups, width: count, first: 0 };
            stack.multiply(simd, x_groups.groups(), lists, Places { groups: &mut out, width, first: 2 });
            check(&out, width, 2, 0);
            if let Some(second) = [(2, 1), (9, 3)].into_iter().find_map(|(of, second)| (of == count).then_some(second))
            {
                let mut out = vec![[f64::NAN; WIDTH]; (count + second) * size.div_ceil(WIDTH)];
                stack.multiply_two(simd, [x_groups.groups(), y_groups.groups()], &start_groups, &mut out);
                check(&out, count + second, 0, second);
            }
        }
    }

    /// Independent reference: the products row by row.
    #[test]
    fn products_equal_the_dense_ones_for_any_size() {
        for count in [1, 2, 3, 6, 9] {
            for size in [1, 2, 3, 4, 5, 7, 8, 13, 16, 29, 46] {
                Arch::new().dispatch(Products { count, size });
                Products { count, size }.with_simd(Scalar::new());
            }
        }
    }

    /// Independent reference: the sums list by list.
    #[test]
    fn sums_of_lists_side_by_side_are_those_of_the_lists() {
        let lists: Vec<Vec<f64>> = (0..9).map(|k| (0..10).map(|i| ((k * 10 + i) as f64).sin()).collect()).collect();
        let groups = side_by_side(&lists);
        let all = Lists { groups: &groups, width: 9, first: 0 };
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let simd = Scalar::new();
        let x = Padded::from_slice(&lists[7]);
        for (k, found) in dots::<_, 3>(simd, Lists { first: 2, ..all }, x.groups()).into_iter().enumerate() {
            assert!((found - dot(&lists[k + 2], &lists[7])).abs() < 1e-14);
        }
        // Two lists by y, and three with others besides by x.
        let start: Vec<Vec<f64>> = lists.iter().rev().take(5).cloned().collect();
        let [x, y] = [&lists[7], &lists[8]].map(|list| Padded::from_slice(list));
        let five = side_by_side(&lists[..5]);
        let (by_y, by_x) = locked_dots::<_, 2, 3, 5, 5>(simd, &five, &side_by_side(&start), [x.groups(), y.groups()]);
        assert!((0..2).all(|k| (by_y[k] - dot(&lists[k], &y)).abs() < 1e-14));
        assert!((0..3).all(|k| (by_x[k] - dot(&lists[2 + k], &x) - dot(&start[2 + k], &x)).abs() < 1e-14));
        let own = own_products::<_, 3>(simd, all);
        for (j, k) in (0..3).flat_map(|j| (0..3).map(move |k| (j, k))) {
            assert!((own[j.max(k)][j.min(k)] - dot(&lists[j], &lists[k])).abs() < 1e-14);
        }
        for count in [0, 1, 2, 3, 6, 9] {
            let factors: Vec<f64> = (0..count).map(|k| k as f64 - 1.5).collect();
            let (mut sum, mut more) = (Padded::from_slice(&[f64::NAN; 10]), Padded::from_slice(&lists[0]));
            combine(simd, all, &factors, sum.groups_mut());
            add_combined(simd, all, &factors, more.groups_mut());
            for i in 0..10 {
                let expected: f64 = factors.iter().zip(&lists).map(|(factor, list)| factor * list[i]).sum();
                assert!((sum[i] - expected).abs() < 1e-14 && (more[i] - lists[0][i] - expected).abs() < 1e-14);
            }
        }
    }
}
