//! Orthonormal blocks from their Gram matrices: Stathopoulos and Wu (2002).

use faer::Mat;

use crate::error::ModalError;
use crate::matrix::dense::symmetric_eigen;

/// The most that one round stretches a direction is the inverse of this; its Gram matrix is blind below.
const STRETCH: f64 = 1e-7;

/// Orthonormalisation of a block from its Gram matrix WᵀMW: W·transform is closer to orthonormal than W, and
/// W = (W·transform)·inverse up to what is dropped.
pub(crate) struct Svqb {
    pub transform: Mat<f64>,
    pub inverse: Mat<f64>,
    /// The block was so far from dependent that W·transform is orthonormal, to rounding or nearly so.
    pub well_conditioned: bool,
}

impl Svqb {
    /// `norms` scale the columns; `keep` is asked with each eigenvalue of the scaled Gram matrix and its length in W. The block
    /// is well conditioned where all of them are above `well`.
    pub(crate) fn new(
        gram: &Mat<f64>,
        norms: &[f64],
        well: f64,
        keep: impl Fn(f64, f64) -> bool,
    ) -> Result<Self, ModalError> {
        let size = gram.nrows();
        let unit = |i: usize| if norms[i] > 0.0 { 1.0 / norms[i] } else { 0.0 };
        let scaled = Mat::from_fn(size, size, |i, j| 0.5 * (gram[(i, j)] + gram[(j, i)]) * unit(i) * unit(j));
        let (values, u) = symmetric_eigen(&scaled)?;
        let root = |k: usize| values[k].max(STRETCH * STRETCH).sqrt();
        let length = |k: usize| root(k) * (0..size).map(|i| (u[(i, k)] * norms[i]).powi(2)).sum::<f64>().sqrt();
        let kept: Vec<usize> = (0..size).filter(|k| keep(values[*k], length(*k))).collect();
        Ok(Self {
            transform: Mat::from_fn(size, kept.len(), |i, j| unit(i) * u[(i, kept[j])] / root(kept[j])),
            inverse: Mat::from_fn(kept.len(), size, |i, j| root(kept[i]) * u[(j, kept[i])] * norms[j]),
            well_conditioned: kept.iter().all(|k| values[*k] > well),
        })
    }
}

/// Lengths of the columns that have a Gram matrix.
pub(crate) fn norms(gram: &Mat<f64>) -> Vec<f64> {
    (0..gram.nrows()).map(|i| gram[(i, i)].max(0.0).sqrt()).collect()
}
