//! Sums over lists.

/// aᵀb, as far as the shorter list goes. Four sums run side by side, so that none waits for the other.
#[inline(always)]
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let length = a.len().min(b.len());
    let (a, a_rest) = a[..length].as_chunks::<4>();
    let (b, b_rest) = b[..length].as_chunks::<4>();
    let mut sums = [0.0; 4];
    for (a, b) in a.iter().zip(b) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a * b;
        }
    }
    for ((sum, a), b) in sums.iter_mut().zip(a_rest).zip(b_rest) {
        *sum += a * b;
    }
    total(sums)
}

/// Σ w_k x_k², as far as the shorter list goes.
pub(crate) fn weighted_squares(weights: &[f64], x: &[f64]) -> f64 {
    let length = weights.len().min(x.len());
    let (weights, weights_rest) = weights[..length].as_chunks::<4>();
    let (x, x_rest) = x[..length].as_chunks::<4>();
    let mut sums = [0.0; 4];
    for (weights, x) in weights.iter().zip(x) {
        for ((sum, weight), x) in sums.iter_mut().zip(weights).zip(x) {
            *sum += weight * (x * x);
        }
    }
    for ((sum, weight), x) in sums.iter_mut().zip(weights_rest).zip(x_rest) {
        *sum += weight * (x * x);
    }
    total(sums)
}

/// The sum of four.
#[inline(always)]
pub(crate) fn total(sums: [f64; 4]) -> f64 {
    (sums[0] + sums[2]) + (sums[1] + sums[3])
}

/// The larger of two numbers. NaN stays, where `max` would drop it.
#[inline(always)]
pub(crate) fn larger(most: f64, other: f64) -> f64 {
    if most.is_nan() || other <= most { most } else { other }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Independent reference: the sum term by term.
    #[test]
    fn weighted_squares_are_summed_to_the_last() {
        for length in 0..13_usize {
            let list = |phase: f64| -> Vec<f64> { (0..length).map(|k| (k as f64 + phase).sin()).collect() };
            let (weights, x) = (list(0.1), list(0.7));
            let expected: f64 = weights.iter().zip(&x).map(|(w, x)| w * x * x).sum();
            assert!((weighted_squares(&weights, &x) - expected).abs() < 1e-14, "{length}");
        }
    }
}
