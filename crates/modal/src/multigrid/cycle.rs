//! A cycle of two levels in the place of K⁻¹: smoothing with all nodes, and the solution on the corners.
//!
//! ```text
//! before:    x = S r,   r' = r − K x            S: Chebyshev polynomial of D⁻¹K times D⁻¹, D the diagonal blocks of K
//! corners:   x += P (PᵀKP + s PᵀMP)⁻¹ Pᵀ r'
//! after:     x += S (r − K x)
//! ```
//!
//! Symmetric and positive definite, and as near to K⁻¹ for any size of the mesh where its elements are about as long as they
//! are thick: of flat ones the corners alone are far too stiff in bending. Brandt (1977); of second-order elements the step
//! to the corners is a step in the order of the polynomials ("p-multigrid").

use faer::{Mat, MatMut};

use crate::error::ModalError;
use crate::factor::shifted::{Shifted, SolveScratch};
use crate::multigrid::coarse::Corners;
use crate::multigrid::smoother::{MAX_COLUMNS, Smoother, Smoothing, pack, unpack};

/// The cycle.
pub(crate) struct Multigrid<'a> {
    smoothing: Smoothing<'a>,
    corners: &'a Corners,
    factor: &'a Shifted,
    /// Rows and columns of the corners, and scratch for their solution, which are used again.
    rows: Vec<f32>,
    columns: Mat<f64>,
    solve: SolveScratch,
}

impl<'a> Multigrid<'a> {
    /// With the factor of the matrices over corners.
    pub(crate) fn new(smoother: &'a Smoother, corners: &'a Corners, factor: &'a Shifted) -> Result<Self, ModalError> {
        memory::check("the multigrid cycle", Self::bytes(corners))?;
        let unknowns = 3 * corners.count();
        Ok(Self {
            smoothing: Smoothing::new(smoother, MAX_COLUMNS),
            corners,
            factor,
            rows: vec![0.0; unknowns * MAX_COLUMNS],
            columns: Mat::zeros(unknowns, MAX_COLUMNS),
            solve: factor.solve_scratch(MAX_COLUMNS)?,
        })
    }

    /// Memory held, bytes.
    pub(crate) fn bytes(corners: &Corners) -> usize {
        Smoothing::bytes(corners.nodes_in_all())
            + 3 * corners.count() * MAX_COLUMNS * (size_of::<f32>() + size_of::<f64>())
    }

    /// Replaces forces (3n×k) by displacements.
    pub(crate) fn apply(&mut self, mut forces: MatMut<'_, f64>) {
        for first in (0..forces.ncols()).step_by(MAX_COLUMNS) {
            let count = MAX_COLUMNS.min(forces.ncols() - first);
            let mut columns = forces.as_mut().subcols_mut(first, count);
            let units = self.smoothing.begin(columns.as_ref());
            self.smoothing.smooth(false);
            self.smoothing.take_in();
            self.solve_for_corners(count);
            self.smoothing.smooth(true);
            self.smoothing.end(units, columns.as_mut());
        }
    }

    /// Makes d the answer of the corners to r.
    fn solve_for_corners(&mut self, count: usize) {
        let Self { smoothing: Smoothing { smoother, width, r, d, .. }, corners, factor, rows, columns, solve } = self;
        let rows = &mut rows[..3 * corners.count() * *width];
        let mut columns = columns.as_mut().subcols_mut(0, count);
        corners.restrict(3 * *width, r, rows);
        unpack([&*rows], [1.0; MAX_COLUMNS], columns.as_mut());
        factor.solve_in_place(columns.as_mut(), solve);
        pack(columns.as_ref(), [smoother.unit; MAX_COLUMNS], rows);
        corners.prolong(3 * *width, rows, d);
    }
}
