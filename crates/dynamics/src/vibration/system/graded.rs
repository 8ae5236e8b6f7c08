//! Eigenvalues of a symmetric matrix whose magnitudes are far apart.

use faer::{Mat, Side};

use crate::vibration::system::error::SteadyError;

/// An eigenvalue below this part of the largest is found anew among its like: the solver knows it to rounding of the largest only.
const SLOW: f64 = 1e-6;

/// Eigenvalues of a symmetric matrix, smallest magnitudes exact beside large ones, with their unit vectors; they rise.
pub(super) fn graded_modes(matrix: &Mat<f64>) -> Result<Vec<(f64, Vec<f64>)>, SteadyError> {
    let eigen = matrix.self_adjoint_eigen(Side::Lower).map_err(|_| SteadyError::Numbers)?;
    let values = eigen.S().column_vector();
    let largest = values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    let (slow, fast): (Vec<usize>, Vec<usize>) = (0..values.nrows()).partition(|k| values[*k].abs() < SLOW * largest);
    let shape = |k: usize| (0..matrix.nrows()).map(|i| eigen.U()[(i, k)]).collect::<Vec<f64>>();
    let mut modes: Vec<(f64, Vec<f64>)> = fast.into_iter().map(|k| (values[k], shape(k))).collect();
    if !slow.is_empty() {
        // Their part of the matrix has no rounding of the fast ones: these hardly move in them, and quadratically less in it.
        let basis = Mat::from_fn(matrix.nrows(), slow.len(), |i, k| eigen.U()[(i, slow[k])]);
        let part = basis.transpose() * (matrix * &basis);
        for (value, of_slow) in graded_modes(&part)? {
            let shape = (0..matrix.nrows())
                .map(|i| of_slow.iter().enumerate().map(|(k, part)| basis[(i, k)] * part).sum())
                .collect();
            modes.push((value, shape));
        }
    }
    modes.sort_by(|a, b| a.0.total_cmp(&b.0));
    Ok(modes)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed form: a slow vibration √(k/M) beside a fast one, turned into each other: masses 1 and springs of 1e14 and 1e-6.
    #[test]
    fn slow_vibrations_are_found_beside_fast_ones() {
        let (sine, cosine) = (1e-10_f64, (1.0 - 1e-20_f64).sqrt());
        let squares = [1e14, 1e-6, 3e-6];
        // K = T diag T', with a turn of the first two that is as small as those of Linearization are.
        let turn = [[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]];
        let entry = |i: usize, j: usize| (0..3).map(|k| turn[i][k] * squares[k] * turn[j][k]).sum::<f64>();
        let found: Vec<f64> =
            graded_modes(&Mat::from_fn(3, 3, entry)).unwrap().into_iter().map(|(square, _)| square).collect();
        for (found, expected) in found.iter().zip([1e-6, 3e-6, 1e14]) {
            assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
        }
    }
}
