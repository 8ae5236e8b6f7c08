//! The frequency of a measured vibration.

use nalgebra::{DMatrix, DVector};

/// The circular frequency at which `a + Σ_{k ≤ harmonics} b_k cos kωt + c_k sin kωt` fits the samples best, near `guess`.
pub fn frequency(times: &[f64], values: &[f64], guess: f64, harmonics: usize) -> f64 {
    let left = |omega: f64| {
        let columns = 1 + 2 * harmonics;
        let basis = DMatrix::from_fn(times.len(), columns, |i, j| {
            let phase = (j.div_ceil(2)) as f64 * omega * times[i];
            if j % 2 == 1 { phase.sin() } else { phase.cos() }
        });
        let values = DVector::from_column_slice(values);
        let normal = basis.tr_mul(&basis);
        let fit = normal.lu().solve(&basis.tr_mul(&values)).unwrap_or_else(|| DVector::zeros(columns));
        (values - basis * fit).norm_squared()
    };
    let span = times.last().copied().unwrap_or_default() - times.first().copied().unwrap_or_default();
    // The best of a fine row, then by golden section.
    let width = 0.25 * std::f64::consts::TAU / span;
    let count = 81.max((0.4 * guess / (0.1 * width)) as usize);
    let fine = |i: usize| guess + 0.4 * guess * (i as f64 / (count - 1) as f64 - 0.5);
    let best = (0..count).map(fine).min_by(|a, b| left(*a).total_cmp(&left(*b))).unwrap_or(guess);
    let (mut low, mut high) = (best - 0.2 * width, best + 0.2 * width);
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    for _ in 0..60 {
        let (a, b) = (high - golden * (high - low), low + golden * (high - low));
        if left(a) < left(b) { high = b } else { low = a }
    }
    0.5 * (low + high)
}
