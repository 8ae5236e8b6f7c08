//! Lists side by side: of each four rows a group of every list.

use pulp::Simd;

use crate::matrix::four::{Four, Group, WIDTH};

/// Some lists among those that are side by side.
#[derive(Clone, Copy)]
pub(crate) struct Lists<'a> {
    /// Groups of all lists.
    pub groups: &'a [Group],
    /// Number of all lists.
    pub width: usize,
    /// The first that counts.
    pub first: usize,
}

impl<'a> Lists<'a> {
    /// No lists: zeros where some are asked for.
    pub(crate) const ZEROS: Self = Self { groups: &[], width: 1, first: 0 };

    /// The lists that count of each four rows, and those after them.
    #[inline(always)]
    pub(crate) fn rows(self) -> Rows<'a> {
        Rows(self)
    }

    /// A copy of list k.
    #[inline(always)]
    pub(crate) fn copy(self, k: usize, out: &mut [Group]) {
        for (row, out) in self.rows().zip(out) {
            *out = row[k];
        }
    }
}

/// The lists of each four rows that count, and those after them. The standard library's chunks would divide.
pub(crate) struct Rows<'a>(Lists<'a>);

impl<'a> Iterator for Rows<'a> {
    type Item = &'a [Group];

    #[inline(always)]
    fn next(&mut self) -> Option<&'a [Group]> {
        let Lists { groups, width, first } = self.0;
        let (row, rest) = groups.split_at_checked(width)?;
        self.0.groups = rest;
        row.get(first..)
    }
}

/// Puts lists side by side.
pub(crate) fn side_by_side(lists: &[Vec<f64>]) -> Vec<Group> {
    let length = lists.first().map_or(0, Vec::len);
    let number = |list: &Vec<f64>, i: usize| list.get(i).copied().unwrap_or(0.0);
    let groups = (0..length).step_by(WIDTH);
    groups.flat_map(|i| lists.iter().map(move |list| std::array::from_fn(|lane| number(list, i + lane)))).collect()
}

/// list_kᵀx of the first M lists.
#[inline(always)]
pub(crate) fn dots<S: Simd, const M: usize>(simd: S, lists: Lists<'_>, x: &[Group]) -> [f64; M] {
    let mut sums = [Four::splat(simd, 0.0); M];
    for (row, x) in lists.rows().zip(x) {
        let Some(row) = row.first_chunk::<M>() else { break };
        let x = Four::load(simd, x);
        for k in 0..M {
            sums[k] = Four::load(simd, &row[k]).mul_add(simd, x, sums[k]);
        }
    }
    totals(sums)
}

/// Sums that a locked body asks for, of lists in rows of W: the first A by y, and the P after them, each with a list of
/// `start` besides, by x. The rows of `start` have L lists, and those that count begin at A, too.
#[inline(always)]
pub(crate) fn locked_dots<S: Simd, const A: usize, const P: usize, const L: usize, const W: usize>(
    simd: S,
    lists: &[Group],
    start: &[Group],
    [x, y]: [&[Group]; 2],
) -> ([f64; A], [f64; P]) {
    let (mut by_y, mut by_x) = ([Four::splat(simd, 0.0); A], [Four::splat(simd, 0.0); P]);
    let rows = lists.as_chunks::<W>().0.iter().zip(start.as_chunks::<L>().0);
    for ((row, start), (x, y)) in rows.zip(x.iter().zip(y)) {
        let (x, y) = (Four::load(simd, x), Four::load(simd, y));
        for k in 0..A {
            by_y[k] = Four::load(simd, &row[k]).mul_add(simd, y, by_y[k]);
        }
        for k in 0..P {
            let both = Four::load(simd, &row[A + k]).add(simd, Four::load(simd, &start[A + k]));
            by_x[k] = both.mul_add(simd, x, by_x[k]);
        }
    }
    (totals(by_y), totals(by_x))
}

/// The totals of sums that run side by side.
#[inline(always)]
pub(crate) fn totals<S: Simd, const M: usize>(sums: [Four<S>; M]) -> [f64; M] {
    let mut totals = [0.0; M];
    for (total, sum) in totals.iter_mut().zip(sums) {
        *total = sum.sum();
    }
    totals
}

/// list_jᵀlist_k for k ≤ j, of the first M lists.
#[inline(always)]
pub(crate) fn own_products<S: Simd, const M: usize>(simd: S, lists: Lists<'_>) -> [[f64; M]; M] {
    let mut sums = [[Four::splat(simd, 0.0); M]; M];
    for row in lists.rows() {
        let Some(row) = row.first_chunk::<M>() else { break };
        for j in 0..M {
            let list = Four::load(simd, &row[j]);
            for k in 0..=j {
                sums[j][k] = Four::load(simd, &row[k]).mul_add(simd, list, sums[j][k]);
            }
        }
    }
    let mut products = [[0.0; M]; M];
    for (products, sums) in products.iter_mut().zip(sums) {
        *products = totals(sums);
    }
    products
}

/// out = Σ factor_k list_k
#[inline(always)]
pub(crate) fn combine<S: Simd>(simd: S, lists: Lists<'_>, factors: &[f64], out: &mut [Group]) {
    by_count::<S, false>(simd, lists, factors, out);
}

/// out += Σ factor_k list_k
#[inline(always)]
pub(crate) fn add_combined<S: Simd>(simd: S, lists: Lists<'_>, factors: &[f64], out: &mut [Group]) {
    by_count::<S, true>(simd, lists, factors, out);
}

/// The counts that three axes or one, with all their pairs or none, come to.
#[inline(always)]
fn by_count<S: Simd, const ADD: bool>(simd: S, lists: Lists<'_>, factors: &[f64], out: &mut [Group]) {
    match factors.len() {
        0 if ADD => {}
        0 => out.fill([0.0; WIDTH]),
        1 => sum::<S, 1, ADD>(simd, lists, factors, out),
        2 => sum::<S, 2, ADD>(simd, lists, factors, out),
        3 => sum::<S, 3, ADD>(simd, lists, factors, out),
        6 => sum::<S, 6, ADD>(simd, lists, factors, out),
        _ => sum::<S, 9, ADD>(simd, lists, factors, out),
    }
}

#[inline(always)]
fn sum<S: Simd, const M: usize, const ADD: bool>(simd: S, lists: Lists<'_>, factors: &[f64], out: &mut [Group]) {
    let mut splat = [Four::splat(simd, 0.0); M];
    let Some(factors) = factors.first_chunk::<M>() else { return };
    for (splat, factor) in splat.iter_mut().zip(factors) {
        *splat = Four::splat(simd, *factor);
    }
    for (row, out) in lists.rows().zip(out) {
        let Some(row) = row.first_chunk::<M>() else { return };
        let mut sum = if ADD { Four::load(simd, out) } else { Four::splat(simd, 0.0) };
        for k in 0..M {
            sum = Four::load(simd, &row[k]).mul_add(simd, splat[k], sum);
        }
        sum.store(out);
    }
}
