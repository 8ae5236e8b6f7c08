//! Rows of several vectors: the numbers of a row lie side by side, and are worked on with the processor's vectors.

use pulp::Simd;

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

/// Asks for numbers that are due soon. The processor does not look as far ahead by itself.
#[inline(always)]
#[expect(unsafe_code, reason = "the instruction of the processor has no safe name")]
pub(crate) fn prefetch(number: *const f64) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: a hint, which reads nothing: any address will do. All processors of the kind have it.
    unsafe {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        _mm_prefetch::<_MM_HINT_T0>(number.cast());
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = number;
}
