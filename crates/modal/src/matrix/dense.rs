//! Small dense eigenvalue problems.

use faer::diag::Diag;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltError;
use faer::linalg::evd::{ComputeEigenvectors, self_adjoint_evd, self_adjoint_evd_scratch};
use faer::linalg::triangular_solve::solve_upper_triangular_in_place;
use faer::{Mat, Par, Side};

use crate::error::ModalError;

/// Eigenvalues of a symmetric matrix, smallest first, and its orthonormal eigenvectors.
///
/// faer 0.24 divides and conquers above size 128, and deflates by an absolute threshold there: eigenvectors of a
/// matrix of magnitude 1e-13 come out with a relative residual of 1e-3. So the matrix is scaled to one before, as
/// LAPACK does. A matrix of size 0×0 makes faer panic. It runs on one thread, so that the result does not depend on
/// their number.
pub(crate) fn symmetric_eigen(matrix: &Mat<f64>) -> Result<(Vec<f64>, Mat<f64>), ModalError> {
    let size = matrix.nrows();
    let scale = matrix.norm_max();
    if size == 0 || scale == 0.0 {
        return Ok((vec![0.0; size], Mat::identity(size, size)));
    }
    let failed = |_| ModalError::DenseEigen { size };
    let (mut values, mut vectors) = (Diag::<f64>::zeros(size), Mat::zeros(size, size));
    let scratch = self_adjoint_evd_scratch::<f64>(size, ComputeEigenvectors::Yes, Par::Seq, Default::default());
    self_adjoint_evd(
        (matrix * faer::Scale(1.0 / scale)).as_ref(),
        values.as_mut(),
        Some(vectors.as_mut()),
        Par::Seq,
        MemStack::new(&mut MemBuffer::try_new(scratch).map_err(|_| ModalError::DenseEigen { size })?),
        Default::default(),
    )
    .map_err(failed)?;
    Ok((values.column_vector().iter().map(|value| scale * value).collect(), vectors))
}

/// L⁻ᵀ of a positive definite matrix L Lᵀ; the matrix turned by it on both sides is the identity.
pub(crate) fn whitening(matrix: &Mat<f64>) -> Result<Mat<f64>, LltError> {
    let factor = matrix.llt(Side::Lower)?;
    let mut whitening = Mat::identity(matrix.nrows(), matrix.nrows());
    solve_upper_triangular_in_place(factor.L().transpose(), whitening.as_mut(), Par::Seq);
    Ok(whitening)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Conserved: A v = λ v, and the vectors are orthonormal.
    #[test]
    fn eigenpairs_are_accurate_at_every_scale() {
        // A band matrix with falling entries, as block Lanczos makes them.
        let n = 200;
        let a = Mat::from_fn(n, n, |i, j| {
            let decay = 1.0 / (1.0 + i.max(j) as f64).powi(2);
            if i.abs_diff(j) <= 8 { decay * (1.0 + 0.1 * ((i + j) as f64).sin()) } else { 0.0 }
        });
        for scale in [1e-200, 1e-13, 1.0, 1e15] {
            let scaled = Mat::from_fn(n, n, |i, j| scale * 0.5 * (a[(i, j)] + a[(j, i)]));
            let (values, vectors) = symmetric_eigen(&scaled).unwrap();
            assert!(values.is_sorted());
            let residual = &scaled * &vectors - Mat::from_fn(n, n, |i, j| vectors[(i, j)] * values[j]);
            assert!(residual.norm_max() < 1e-13 * scale, "{:e}", residual.norm_max() / scale);
            assert!((vectors.transpose() * &vectors - Mat::<f64>::identity(n, n)).norm_max() < 1e-13);
        }
    }

    /// Closed form: the eigenvalues of the zero matrix are 0.
    #[test]
    fn nothing_and_zero_have_eigenvalues_too() {
        assert!(symmetric_eigen(&Mat::zeros(0, 0)).unwrap().0.is_empty());
        assert_eq!(symmetric_eigen(&Mat::zeros(3, 3)).unwrap().0, [0.0; 3]);
    }
}
