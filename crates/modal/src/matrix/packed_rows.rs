//! Rows of several vectors: the numbers of a row lie side by side, and are worked on with the processor's vectors.

use pulp::Simd;

/// Numbers of the factors that are asked for ahead of their use.
const AHEAD: usize = 384;

/// row += factor · x.
#[inline(always)]
pub(crate) fn add_multiple<const W: usize, S: Simd>(simd: S, row: &mut [f64; W], factor: f64, x: &[f64; W]) {
    let ((row, rest), (x, of_rest)) = (S::as_mut_simd_f64s(row), S::as_simd_f64s(x));
    row.iter_mut().zip(x).for_each(|(row, x)| *row = simd.mul_add_e_f64s(simd.splat_f64s(factor), *x, *row));
    rest.iter_mut().zip(of_rest).for_each(|(row, x)| *row += factor * x);
}

/// row −= taken.
#[inline(always)]
pub(crate) fn subtract<const W: usize, S: Simd>(simd: S, row: &mut [f64; W], taken: &[f64; W]) {
    let ((row, rest), (taken, of_rest)) = (S::as_mut_simd_f64s(row), S::as_simd_f64s(taken));
    row.iter_mut().zip(taken).for_each(|(x, taken)| *x = simd.sub_f64s(*x, *taken));
    rest.iter_mut().zip(of_rest).for_each(|(x, taken)| *x -= taken);
}

/// row ← factor · row.
#[inline(always)]
pub(crate) fn scale<const W: usize, S: Simd>(simd: S, row: &mut [f64; W], factor: f64) {
    let (row, rest) = S::as_mut_simd_f64s(row);
    row.iter_mut().for_each(|x| *x = simd.mul_f64s(*x, simd.splat_f64s(factor)));
    rest.iter_mut().for_each(|x| *x *= factor);
}

/// rows += columns · x.
#[inline(always)]
pub(crate) fn add_combinations<const K: usize, const W: usize, S: Simd>(
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
pub(crate) fn add_products<const K: usize, const W: usize, S: Simd>(
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

/// Asks for numbers that are due soon. The processor does not look as far ahead by itself.
#[inline(always)]
#[cfg_attr(target_arch = "x86_64", expect(unsafe_code, reason = "the instruction of the processor has no safe name"))]
pub(crate) fn prefetch<T>(number: *const T) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: a hint, which reads nothing: any address will do. All processors of the kind have it.
    unsafe {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        _mm_prefetch::<_MM_HINT_T0>(number.cast());
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = number;
}
