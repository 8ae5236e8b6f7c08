//! Modes of a body some of whose motions are forbidden: Eq. (J20) of `docs/method/systems.md`.

use faer::{MatRef, Side};

use crate::error::ModalError;
use crate::input::check_finite_columns;
use crate::solve::Modes;

/// Singular values of the rows below this part of the largest are rounding.
const DEPENDENT: f64 = 1e-9;

impl Modes {
    /// The Rayleigh–Ritz vectors of those combinations of the modes and static shapes whose amplitudes q keep `rows` q = 0 (m×nf): exact
    /// for static responses where these span the responses to the forces that hold the rows. As many of them as before, at most, are
    /// called natural; of modes that are combined with a static response, none.
    ///
    /// # Errors
    /// [`ModalError::Size`], [`ModalError::NotFinite`], [`ModalError::DenseEigen`].
    pub fn restricted(&self, rows: MatRef<'_, f64>) -> Result<Self, ModalError> {
        let size = self.shapes.ncols();
        crate::input::check_rows("amplitudes of restricted modes", rows.ncols(), size)?;
        check_finite_columns("restrictions of modes", rows)?;
        let failed = |_| ModalError::DenseEigen { size };
        let svd = rows.svd().map_err(|_| ModalError::DenseEigen { size })?;
        let values = svd.S().column_vector();
        let largest = values.iter().copied().fold(0.0, f64::max);
        let rank = values.iter().filter(|value| **value > DEPENDENT * largest).count();
        let free = svd.V().subcols(rank, size - rank);
        let stiff = self.stiffness() * free;
        let eigen = (free.transpose() * stiff).self_adjoint_eigen(Side::Lower).map_err(failed)?;
        let natural = self.natural().min(size - rank);
        let first = |list: &[f64]| list.iter().copied().take(natural).collect();
        Ok(Self {
            rigid: self.rigid.clone(),
            eigenvalues: eigen.S().column_vector().iter().copied().collect(),
            shapes: &self.shapes * (free * eigen.U()),
            residuals: first(&self.residuals),
            force_residuals: first(&self.force_residuals),
            answer: None,
            stats: self.stats,
        })
    }
}
