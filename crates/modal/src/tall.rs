//! Products of tall matrices: N rows, few columns.
//!
//! The rows are cut at fixed places and sums are taken in a fixed order, so the result does not depend, to the last
//! bit, on the number of threads, nor on the vector instructions of the processor.
//!
//! The loops are our own: faer's product of matrices takes twice the size of the processor's last cache as scratch, for
//! each thread, to multiply matrices of any size. That is more than a small body needs in all.

use std::borrow::Cow;

use faer::{Accum, Mat, MatMut, MatRef};
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

/// Rows that one task computes.
const ROWS: usize = 4096;
/// Rows that stay in the processor's first cache.
const STRIP: usize = 256;
/// Columns of the left factor that are taken together.
const DEPTH: usize = 32;
/// Columns of the product that are made together.
const WIDTH: usize = 8;
/// Numbers that an instruction handles.
const LANES: usize = 4;

/// AᵀB.
pub(crate) fn inner(a: MatRef<'_, f64>, b: MatRef<'_, f64>) -> Mat<f64> {
    let arch = Arch::new();
    let zero = || Mat::zeros(a.ncols(), b.ncols());
    let parts: Vec<Mat<f64>> = a
        .par_row_chunks(ROWS)
        .zip(b.par_row_chunks(ROWS))
        .map(|(a, b)| {
            let (a, b) = (columns(a), columns(b));
            let mut part = zero();
            arch.dispatch(AddInner { sums: part.as_mut(), a: &a, b: &b });
            part
        })
        .collect();
    parts.into_iter().fold(zero(), |sum, part| sum + part)
}

/// Y = A·H, or Y += `factor`·A·H.
pub(crate) fn multiply(mut y: MatMut<'_, f64>, beta: Accum, a: MatRef<'_, f64>, h: MatRef<'_, f64>, factor: f64) {
    let arch = Arch::new();
    for first in (0..y.ncols()).step_by(WIDTH) {
        let width = WIDTH.min(y.ncols() - first);
        let entry = |k: usize, c: usize| if c < width { factor * h[(k, first + c)] } else { 0.0 };
        let rows_of_h: Vec<[f64; WIDTH]> = (0..h.nrows()).map(|k| std::array::from_fn(|c| entry(k, c))).collect();
        let block = y.as_mut().subcols_mut(first, width);
        block.par_row_chunks_mut(ROWS).zip(a.par_row_chunks(ROWS)).for_each(|(mut y, a)| {
            let a = columns(a);
            for start in (0..y.nrows()).step_by(STRIP) {
                let rows = STRIP.min(y.nrows() - start);
                let mut sums = [[0.0; STRIP]; WIDTH];
                for (a, h) in a.chunks(DEPTH).zip(rows_of_h.chunks(DEPTH)) {
                    arch.dispatch(AddProducts { sums: &mut sums, a, start, rows, h });
                }
                for (c, sums) in sums.iter().enumerate().take(width) {
                    let y = y.as_mut().col_mut(c).subrows_mut(start, rows);
                    for (y, sum) in y.iter_mut().zip(sums) {
                        *y = if beta == Accum::Add { *y + sum } else { *sum };
                    }
                }
            }
        });
    }
}

/// A·H.
pub(crate) fn product(a: MatRef<'_, f64>, h: MatRef<'_, f64>) -> Mat<f64> {
    let mut y = Mat::zeros(a.nrows(), h.ncols());
    multiply(y.as_mut(), Accum::Replace, a, h, 1.0);
    y
}

/// Takes out of X what it has along the columns of A, X ← X − A·H with H = BᵀX. Returns H.
pub(crate) fn take_out(x: &mut Mat<f64>, a: MatRef<'_, f64>, b: MatRef<'_, f64>) -> Mat<f64> {
    let h = inner(b, x.as_ref());
    multiply(x.as_mut(), Accum::Add, a, h.as_ref(), -1.0);
    h
}

/// The columns of A, then those of B.
pub(crate) fn side_by_side(a: MatRef<'_, f64>, b: MatRef<'_, f64>) -> Mat<f64> {
    let mut all = Mat::zeros(a.nrows(), a.ncols() + b.ncols());
    let (mut first, mut second) = all.as_mut().split_at_col_mut(a.ncols());
    first.copy_from(a);
    second.copy_from(b);
    all
}

/// The columns as slices; copies, should they not lie side by side.
fn columns(a: MatRef<'_, f64>) -> Vec<Cow<'_, [f64]>> {
    let slice = |j: usize| match a.col(j).try_as_col_major() {
        Some(column) => Cow::Borrowed(column.as_slice()),
        None => Cow::Owned(a.col(j).iter().copied().collect()),
    };
    (0..a.ncols()).map(slice).collect()
}

/// Adds AᵀB: four columns of A and two of B at a time, strip by strip.
///
/// A type rather than a closure: what a closure calls is compiled without the vector instructions.
struct AddInner<'a> {
    sums: MatMut<'a, f64>,
    a: &'a [Cow<'a, [f64]>],
    b: &'a [Cow<'a, [f64]>],
}

impl WithSimd for AddInner<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) {
        add_inner(self.sums, self.a, self.b);
    }
}

#[inline(always)]
fn add_inner(mut sums: MatMut<'_, f64>, a: &[Cow<'_, [f64]>], b: &[Cow<'_, [f64]>]) {
    let length = a.first().map_or(0, |column| column.len());
    for start in (0..length).step_by(STRIP) {
        let strip = start..(start + STRIP).min(length);
        for (i, a) in a.chunks(4).enumerate() {
            // The last column again where there are not four; its sums are not asked for.
            let left: [&[f64]; 4] = std::array::from_fn(|k| &a[k.min(a.len() - 1)][strip.clone()]);
            for (j, b) in b.chunks(2).enumerate() {
                let right: [&[f64]; 2] = std::array::from_fn(|k| &b[k.min(b.len() - 1)][strip.clone()]);
                let dots = dots(left, right);
                for (k, dots) in dots.iter().enumerate().take(a.len()) {
                    for (l, dot) in dots.iter().enumerate().take(b.len()) {
                        sums[(4 * i + k, 2 * j + l)] += dot;
                    }
                }
            }
        }
    }
}

#[inline(always)]
fn dots(left: [&[f64]; 4], right: [&[f64]; 2]) -> [[f64; 2]; 4] {
    let mut sums = [[[0.0; LANES]; 2]; 4];
    let (left, left_rest) = split(left);
    let (right, right_rest) = split(right);
    for r in 0..left[0].len().min(right[0].len()) {
        let x: [[f64; LANES]; 4] = std::array::from_fn(|k| left[k][r]);
        let y: [[f64; LANES]; 2] = std::array::from_fn(|k| right[k][r]);
        for (sums, x) in sums.iter_mut().zip(&x) {
            for (sum, y) in sums.iter_mut().zip(&y) {
                for lane in 0..LANES {
                    sum[lane] += x[lane] * y[lane];
                }
            }
        }
    }
    std::array::from_fn(|k| {
        std::array::from_fn(|l| {
            let rest: f64 = left_rest[k].iter().zip(right_rest[l]).map(|(x, y)| x * y).sum();
            sums[k][l].iter().sum::<f64>() + rest
        })
    })
}

/// Whole groups of [`LANES`] numbers, cut to one length, and what is left.
#[inline(always)]
fn split<const N: usize>(columns: [&[f64]; N]) -> ([&[[f64; LANES]]; N], [&[f64]; N]) {
    let parts = columns.map(|column| column.as_chunks());
    let groups = parts[0].0.len();
    (parts.map(|(whole, _)| &whole[..groups]), parts.map(|(_, rest)| rest))
}

/// Adds the products of some columns of A, `rows` of them from `start`, with as many rows of H.
struct AddProducts<'a> {
    sums: &'a mut [[f64; STRIP]; WIDTH],
    a: &'a [Cow<'a, [f64]>],
    start: usize,
    rows: usize,
    h: &'a [[f64; WIDTH]],
}

impl WithSimd for AddProducts<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) {
        add_products(self.sums, self.a, self.start, self.rows, self.h);
    }
}

#[inline(always)]
fn add_products(sums: &mut [[f64; STRIP]; WIDTH], a: &[Cow<'_, [f64]>], start: usize, rows: usize, h: &[[f64; WIDTH]]) {
    let whole = rows - rows % LANES;
    for row in (0..whole).step_by(LANES) {
        let mut tile = [[0.0; LANES]; WIDTH];
        for (a, h) in a.iter().zip(h) {
            let mut x = [0.0; LANES];
            x.copy_from_slice(&a[start + row..start + row + LANES]);
            for (sums, h) in tile.iter_mut().zip(h) {
                for lane in 0..LANES {
                    sums[lane] += x[lane] * h;
                }
            }
        }
        for (sums, tile) in sums.iter_mut().zip(&tile) {
            for (sum, tile) in sums[row..row + LANES].iter_mut().zip(tile) {
                *sum += tile;
            }
        }
    }
    for row in whole..rows {
        for (c, sums) in sums.iter_mut().enumerate() {
            sums[row] += a.iter().zip(h).map(|(a, h)| a[start + row] * h[c]).sum::<f64>();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_in_pieces_equal_the_whole() {
        let n = 2 * ROWS + 77;
        let a = Mat::from_fn(n, 5, |i, j| ((i * 7 + j * 13) as f64).cos());
        let b = Mat::from_fn(n, 3, |i, j| ((i * 3 + j * 11) as f64).sin());
        let h = inner(a.as_ref(), b.as_ref());
        assert!((&h - a.transpose() * &b).norm_max() < 1e-10);
        let expected = &b - &a * &h * faer::Scale(0.5);
        let mut y = b.clone();
        multiply(y.as_mut(), Accum::Add, a.as_ref(), h.as_ref(), -0.5);
        assert!((&y - &expected).norm_max() < 1e-9);
        assert!((product(a.as_ref(), h.as_ref()) - &a * &h).norm_max() < 1e-9);
    }
}
