//! Products of tall matrices: N rows, few columns.
//!
//! The rows are cut at fixed places and sums are taken in a fixed order, so the result does not depend, to the last
//! bit, on the number of threads.
//!
//! The loops are our own: faer's product of matrices takes twice the size of the processor's last cache as scratch, for
//! each thread, to multiply matrices of any size. That is more than a small body needs in all.

use std::borrow::Cow;

use faer::{Accum, Mat, MatMut, MatRef};
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use crate::matrix::row_chunks::{row_chunks, row_chunks_mut};

/// Rows that one task computes.
const ROWS: usize = 4096;
/// Rows that stay in the processor's first cache.
const STRIP: usize = 256;
/// Columns of the left factor that are taken together: few, so that the processor foresees what is read next of each.
const DEPTH: usize = 4;
/// Columns of the product that are made together.
const WIDTH: usize = 8;

/// AᵀB.
pub(crate) fn inner(a: MatRef<'_, f64>, b: MatRef<'_, f64>) -> Mat<f64> {
    inner_of_blocks(&[a], b)
}

/// AᵀB, where A consists of blocks beside each other.
pub(crate) fn inner_of_blocks(a: &[MatRef<'_, f64>], b: MatRef<'_, f64>) -> Mat<f64> {
    let arch = Arch::new();
    let zero = || Mat::zeros(a.iter().map(|a| a.ncols()).sum(), b.ncols());
    let parts: Vec<Mat<f64>> = row_chunks(b, ROWS)
        .enumerate()
        .map(|(task, b)| {
            let (a, b) = (rows(a, ROWS * task, b.nrows()), columns(b));
            let mut part = zero();
            arch.dispatch(AddInner { sums: part.as_mut(), a: &a, b: &b });
            part
        })
        .collect();
    parts.into_iter().fold(zero(), |sum, part| sum + part)
}

/// Y = A·H, or Y += `factor`·A·H.
pub(crate) fn multiply(y: MatMut<'_, f64>, beta: Accum, a: MatRef<'_, f64>, h: MatRef<'_, f64>, factor: f64) {
    multiply_blocks(y, beta, &[a], h, factor);
}

/// The same, where A consists of blocks beside each other.
pub(crate) fn multiply_blocks(
    mut y: MatMut<'_, f64>,
    beta: Accum,
    a: &[MatRef<'_, f64>],
    h: MatRef<'_, f64>,
    factor: f64,
) {
    let arch = Arch::new();
    for first in (0..y.ncols()).step_by(WIDTH) {
        let width = WIDTH.min(y.ncols() - first);
        let entry = |k: usize, c: usize| if c < width { factor * h[(k, first + c)] } else { 0.0 };
        let rows_of_h: Vec<[f64; WIDTH]> = (0..h.nrows()).map(|k| std::array::from_fn(|c| entry(k, c))).collect();
        let block = y.as_mut().subcols_mut(first, width);
        row_chunks_mut(block, ROWS).enumerate().for_each(|(task, mut y)| {
            let a = rows(a, ROWS * task, y.nrows());
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

/// The columns of matrices of as many rows, one after another.
pub fn side_by_side(parts: &[MatRef<'_, f64>]) -> Mat<f64> {
    let rows = parts.first().map_or(0, MatRef::nrows);
    let mut all = Mat::zeros(rows, parts.iter().map(MatRef::ncols).sum());
    let mut first = 0;
    for part in parts {
        all.as_mut().subcols_mut(first, part.ncols()).copy_from(part);
        first += part.ncols();
    }
    all
}

/// Some rows of all columns of blocks beside each other.
fn rows<'a>(blocks: &[MatRef<'a, f64>], first: usize, count: usize) -> Vec<Cow<'a, [f64]>> {
    blocks.iter().flat_map(|block| columns(block.subrows(first, count))).collect()
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
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { mut sums, a, b } = self;
        let length = a.first().map_or(0, |column| column.len());
        for start in (0..length).step_by(STRIP) {
            let strip = start..(start + STRIP).min(length);
            for (i, a) in a.chunks(4).enumerate() {
                // The last column again where there are not four; its sums are not asked for.
                let left: [&[f64]; 4] = std::array::from_fn(|k| &a[k.min(a.len() - 1)][strip.clone()]);
                for (j, b) in b.chunks(2).enumerate() {
                    let right: [&[f64]; 2] = std::array::from_fn(|k| &b[k.min(b.len() - 1)][strip.clone()]);
                    let dots = dots(simd, left, right);
                    for (k, dots) in dots.iter().enumerate().take(a.len()) {
                        for (l, dot) in dots.iter().enumerate().take(b.len()) {
                            sums[(4 * i + k, 2 * j + l)] += dot;
                        }
                    }
                }
            }
        }
    }
}

#[inline(always)]
fn dots<S: Simd>(simd: S, left: [&[f64]; 4], right: [&[f64]; 2]) -> [[f64; 2]; 4] {
    let left = left.map(S::as_simd_f64s);
    let right = right.map(S::as_simd_f64s);
    let whole = left[0].0.len();
    let (x, y) = (left.map(|(x, _)| &x[..whole]), right.map(|(y, _)| &y[..whole]));
    let mut sums = [[simd.splat_f64s(0.0); 2]; 4];
    for r in 0..whole {
        for k in 0..4 {
            for l in 0..2 {
                sums[k][l] = simd.mul_add_e_f64s(x[k][r], y[l][r], sums[k][l]);
            }
        }
    }
    std::array::from_fn(|k| {
        std::array::from_fn(|l| {
            let rest: f64 = left[k].1.iter().zip(right[l].1).map(|(x, y)| x * y).sum();
            simd.reduce_sum_f64s(sums[k][l]) + rest
        })
    })
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
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { sums, a, start, rows, h } = self;
        let mut parts: [(&[S::f64s], &[f64]); DEPTH] = [(&[], &[]); DEPTH];
        for (part, a) in parts.iter_mut().zip(a) {
            *part = S::as_simd_f64s(&a[start..start + rows]);
        }
        let parts = &parts[..a.len()];
        let whole = rows / S::F64_LANES;
        for r in 0..whole {
            let mut tile = [simd.splat_f64s(0.0); WIDTH];
            for ((x, _), h) in parts.iter().zip(h) {
                let x = x[r];
                for (sum, h) in tile.iter_mut().zip(h) {
                    *sum = simd.mul_add_e_f64s(x, simd.splat_f64s(*h), *sum);
                }
            }
            for (sums, tile) in sums.iter_mut().zip(tile) {
                let sum = &mut S::as_mut_simd_f64s(sums).0[r];
                *sum = simd.add_f64s(*sum, tile);
            }
        }
        for row in whole * S::F64_LANES..rows {
            for (c, sums) in sums.iter_mut().enumerate() {
                sums[row] += a.iter().zip(h).map(|(a, h)| a[start + row] * h[c]).sum::<f64>();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Independent reference: the products of the whole matrices by faer.
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
