//! Bounds of quadratic forms in the spin: ω·Cω ≤ ‖C‖ |ω|², whatever its direction.

use faer::Mat;
use nalgebra::Matrix3;
use reduced_body::ReducedBody;

/// The symmetric 3×3 matrix of six entries in the order of [`ReducedBody::PAIRS`].
pub(crate) fn symmetric(entries: [f64; 6]) -> Matrix3<f64> {
    let mut matrix = Matrix3::zeros();
    for ((i, j), entry) in ReducedBody::PAIRS.into_iter().zip(entries) {
        matrix[(i, j)] = entry;
        matrix[(j, i)] = entry;
    }
    matrix
}

/// Largest magnitude of an eigenvalue.
pub(crate) fn norm(matrix: &Matrix3<f64>) -> f64 {
    matrix.symmetric_eigenvalues().amax()
}

/// ‖c‖ of the 3×3 matrix that mode k has (nf), with `turning` on both sides: B where ω = B y, or a projection.
pub(crate) fn of_modes(first: &[Vec<f64>; 6], turning: &Matrix3<f64>) -> Vec<f64> {
    let nf = first[0].len();
    (0..nf)
        .map(|k| norm(&(turning.transpose() * symmetric(std::array::from_fn(|ij| first[ij][k])) * turning)))
        .collect()
}

/// The same of each pair of modes (nf×nf).
pub(crate) fn of_pairs(second: &[Mat<f64>; 6], turning: &Matrix3<f64>) -> Mat<f64> {
    let nf = second[0].nrows();
    Mat::from_fn(nf, nf, |k, l| {
        norm(&(turning.transpose() * symmetric(std::array::from_fn(|ij| second[ij][(k, l)])) * turning))
    })
}

/// |Σ a_i G_i,kl| of each pair of modes over all unit vectors a that `turning` leaves (nf×nf).
pub(crate) fn of_vectors(gyroscopic: &[Mat<f64>; 3], turning: &Matrix3<f64>) -> Mat<f64> {
    let nf = gyroscopic[0].nrows();
    Mat::from_fn(nf, nf, |k, l| {
        let g = nalgebra::Vector3::from_fn(|i, _| gyroscopic[i][(k, l)]);
        (turning.transpose() * g).norm()
    })
}
