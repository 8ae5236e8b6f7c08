//! Rayleigh–Ritz: the best eigenpairs of (K, M) among the combinations of given vectors.

use faer::Mat;
use faer::reborrow::Reborrow;
use faer::sparse::SparseColMatRef;

use crate::constraints::Constraints;
use crate::dense::{symmetric_eigen, whitening};
use crate::error::ModalError;
use crate::foretold::of_vectors;
use crate::mass_matrix::MassMatrix;
use crate::products::symmetric_product;
use crate::tall;

/// Components this close to the largest magnitude share it; the first of them gives the sign.
const TIE: f64 = 1e-6;

/// Eigenpairs by Rayleigh–Ritz.
pub(crate) struct RitzPairs {
    pub eigenvalues: Vec<f64>,
    /// M-orthonormal, the component of largest magnitude positive.
    pub shapes: Mat<f64>,
    /// ‖Kφ − λMφ‖ / ‖Kφ‖, without the reactions of a support.
    pub force_residuals: Vec<f64>,
}

/// Rayleigh–Ritz of (K, M) on the span of `vectors`.
pub(crate) fn rayleigh_ritz(
    stiffness: SparseColMatRef<'_, usize, f64>,
    mass: &MassMatrix<'_>,
    constraints: &Constraints,
    vectors: &Mat<f64>,
) -> Result<RitzPairs, ModalError> {
    memory::check("the mode shapes and their products with K and M", of_vectors(vectors.nrows(), 5 * vectors.ncols()))?;
    let m_vectors = mass.product(vectors.as_ref());
    let k_vectors = symmetric_product(stiffness, vectors.as_ref());
    let gram = tall::inner(vectors.as_ref(), m_vectors.as_ref());
    // Cholesky of the Gram matrix turns the pencil into an ordinary problem: C = L⁻¹ (VᵀKV) L⁻ᵀ.
    let whitening = whitening(&gram).map_err(|_| ModalError::DenseEigen { size: gram.nrows() })?;
    let projected = whitening.transpose() * tall::inner(vectors.as_ref(), k_vectors.as_ref()) * &whitening;
    let (eigenvalues, vectors_of_projected) = symmetric_eigen(&projected)?;
    let transform = &whitening * vectors_of_projected;

    let mut k_shapes = tall::product(k_vectors.as_ref(), transform.as_ref());
    let mut m_shapes = tall::product(m_vectors.as_ref(), transform.as_ref());
    constraints.project(k_shapes.as_mut());
    constraints.project(m_shapes.as_mut());
    let force_residuals = eigenvalues
        .iter()
        .enumerate()
        .map(|(k, lambda)| {
            (k_shapes.col(k) - m_shapes.col(k) * faer::Scale(*lambda)).norm_l2() / k_shapes.col(k).norm_l2()
        })
        .collect();
    let mut shapes = tall::product(vectors.as_ref(), transform.as_ref());
    fix_signs(&mut shapes);
    Ok(RitzPairs { eigenvalues, shapes, force_residuals })
}

/// Turns each shape so that its component of largest magnitude is positive. Where symmetry makes several components
/// equal in magnitude, rounding must not choose among them: the first one counts.
fn fix_signs(shapes: &mut Mat<f64>) {
    for shape in shapes.col_iter_mut() {
        let largest = shape.norm_max();
        let leading = shape.rb().iter().copied().find(|c| c.abs() >= (1.0 - TIE) * largest).unwrap_or(0.0);
        if leading < 0.0 {
            shape.iter_mut().for_each(|c| *c = -*c);
        }
    }
}
