//! Slow eigenvalues beside fast ones, by inverse iteration, Eq. (L15) of `docs/method/systems.md`: a solver of all of them knows each to rounding of the fastest
//! only.

use faer::prelude::Solve;
use faer::{Mat, c64};

/// Passes, each of which doubles the digits.
const PASSES: usize = 3;
/// Part of an eigenvalue that is its rounding.
const ROUNDING: f64 = 1e-12;

/// The eigenvalue of `s² + s C + K` next to one that is known within `near`, with scales of the coordinates; none where passes lead elsewhere, as
/// where several eigenvalues are one. A growth that is rounding is zero.
pub(super) fn refined([stiffness, damping]: [&Mat<f64>; 2], scales: &[f64], eigenvalue: c64, near: f64) -> Option<c64> {
    let size = scales.len();
    let over = |i: usize, j: usize| 1.0 / (scales[i] * scales[j]);
    let of = |value: f64| c64::new(value, 0.0);
    let diagonal = |i: usize, j: usize| if i == j { 1.0 } else { 0.0 };
    let mut found = eigenvalue;
    for _ in 0..PASSES {
        let dynamic = Mat::from_fn(size, size, |i, j| {
            (found * found * diagonal(i, j) + found * damping[(i, j)] + of(stiffness[(i, j)])) * over(i, j)
        });
        let slope =
            Mat::from_fn(size, size, |i, j| (found * (2.0 * diagonal(i, j)) + of(damping[(i, j)])) * over(i, j));
        // Vectors on both sides of the smallest singular value.
        let vector = |matrix: &Mat<c64>| {
            let factors = matrix.partial_piv_lu();
            let mut x = Mat::from_fn(size, 1, |i, _| c64::new(1.0, 0.1 * (i as f64).sin()));
            for _ in 0..2 {
                x = factors.solve(&x);
                let length = x.norm_l2();
                x = Mat::from_fn(size, 1, |i, _| x[(i, 0)] * (1.0 / length));
            }
            x
        };
        let (right, left) = (vector(&dynamic), vector(&dynamic.transpose().to_owned()));
        let between = |matrix: &Mat<c64>| (left.transpose() * (matrix * &right))[(0, 0)];
        found -= between(&dynamic) / between(&slope);
    }
    let moved = found - eigenvalue;
    if moved.norm() > near || !moved.norm().is_finite() {
        return None;
    }
    if found.re.abs() <= ROUNDING * found.norm() {
        found.re = 0.0;
    }
    Some(found)
}
