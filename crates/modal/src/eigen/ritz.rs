//! Rayleigh–Ritz: the best eigenpairs of (K, M) among the combinations of given vectors.

use faer::reborrow::Reborrow;
use faer::{Accum, Mat, MatMut};
use rayon::prelude::*;

use crate::error::ModalError;
use crate::matrix::dense::{symmetric_eigen, whitening};
use crate::matrix::mass_matrix::MassMatrix;
use crate::matrix::row_chunks::row_chunks_mut;
use crate::matrix::stiffness::StiffnessMatrix;
use crate::matrix::tall;
use crate::memory_estimate::of_vectors;
use crate::support::constraints::Constraints;

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

/// Rows that are worked on together: so few that all columns of them stay in the processor's cache.
const ROWS: usize = 1024;

/// Rayleigh–Ritz of (K, M) on the span of `vectors`.
pub(crate) fn rayleigh_ritz(
    stiffness: StiffnessMatrix<'_>,
    mass: &MassMatrix<'_>,
    constraints: &Constraints,
    vectors: Mat<f64>,
) -> Result<RitzPairs, ModalError> {
    memory::check("the products of the mode shapes with K and M", of_vectors(vectors.nrows(), 2 * vectors.ncols()))?;
    let zeros = || Mat::zeros(vectors.nrows(), vectors.ncols());
    let (mut m_vectors, mut k_vectors, mut packed) = (zeros(), zeros(), Vec::new());
    mass.product_into(vectors.as_ref(), m_vectors.as_mut(), &mut packed);
    stiffness.product_into(vectors.as_ref(), k_vectors.as_mut(), &mut packed);
    drop(packed);
    let gram = tall::inner(vectors.as_ref(), m_vectors.as_ref());
    // Cholesky of the Gram matrix turns the pencil into an ordinary problem: C = L⁻¹ (VᵀKV) L⁻ᵀ.
    let whitening =
        whitening(&gram).map_err(|_| ModalError::NotPositiveDefinite { matrix: "mass", size: gram.nrows() })?;
    let projected = whitening.transpose() * tall::inner(vectors.as_ref(), k_vectors.as_ref()) * &whitening;
    let (eigenvalues, vectors_of_projected) = symmetric_eigen(&projected)?;
    let transform = &whitening * vectors_of_projected;

    constraints.project(k_vectors.as_mut());
    constraints.project(m_vectors.as_mut());
    let scaled = Mat::from_fn(transform.nrows(), transform.ncols(), |i, k| eigenvalues[k] * transform[(i, k)]);
    let mut shapes = vectors;
    // Of each part of the rows: the shapes, in the place of the vectors, and the lengths of Kφ and Kφ − λMφ.
    let of_part = |(task, mut shapes): (usize, MatMut<'_, f64>)| -> Vec<[f64; 2]> {
        let [k_vectors, m_vectors] = [&k_vectors, &m_vectors].map(|of| of.subrows(ROWS * task, shapes.nrows()));
        let mut forces = tall::product(k_vectors, transform.as_ref());
        let lengths: Vec<f64> = forces.col_iter().map(|force| force.norm_l2()).collect();
        tall::multiply(forces.as_mut(), Accum::Add, m_vectors, scaled.as_ref(), -1.0);
        let rotated = tall::product(shapes.rb(), transform.as_ref());
        shapes.copy_from(&rotated);
        lengths.into_iter().zip(forces.col_iter()).map(|(length, rest)| [length, rest.norm_l2()]).collect()
    };
    let parts: Vec<_> = row_chunks_mut(shapes.as_mut(), ROWS).enumerate().map(of_part).collect();
    let length = |k: usize, i: usize| parts.iter().fold(0.0, |length: f64, part| length.hypot(part[k][i]));
    let force_residuals = (0..eigenvalues.len()).map(|k| length(k, 1) / length(k, 0)).collect();
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
