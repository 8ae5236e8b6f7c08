//! How far a body is from buckling.
//!
//! ```text
//! K_σ v = θ K v        K + K_σ loses definiteness where the lowest θ comes to −1
//! ```
//!
//! In a few vibration modes the lowest θ is not low enough: they do not hold the shape in which a body buckles. Here it
//! comes from the whole mesh, by block Lanczos for K⁻¹K_σ in the K-product, with the static responses of
//! [`Solver::static_response`]: it rises to the lowest θ of the mesh from within, and the iteration ends where it stays.

use faer::{Accum, Mat, MatRef};

use crate::eigen::lanczos::random_block;
use crate::error::ModalError;
use crate::input::check_rows;
use crate::matrix::dense::symmetric_eigen;
use crate::matrix::tall;
use crate::solve::Solver;

/// Most vectors of the first block that are given.
const GIVEN: usize = 3;
/// Blocks of the basis, at most.
const MAX_BLOCKS: usize = 10;
/// Relative change of θ at which it counts as found.
const SETTLED: f64 = 1e-5;
/// Smallest part of a vector beside the basis with which it is added.
const DEPENDENT: f64 = 1e-7;

/// How well the lowest buckling ratio is to be known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BucklingAccuracy {
    /// From two blocks: it shows whether loads are far from those at which the body buckles.
    Estimate,
    /// To 1e-4 of itself.
    Full,
}

impl Solver<'_> {
    /// The lowest θ of `K_σ v = θ K v` in the space that the support allows, or 0 where there is none below: the loads
    /// that make K_σ are −θ times those at which the body buckles. Eq. (M12) of `docs/method/modes.md`.
    ///
    /// `product` gives `K_σ V` (N×k) for V (N×k). `start` (N×k) are displacements to begin with, such as vibration modes.
    ///
    /// # Errors
    /// [`ModalError::Size`] for displacements of another body, what `product` returns, and the errors of
    /// [`Solver::static_response`].
    pub fn lowest_buckling_ratio<E: From<ModalError>>(
        &self,
        start: MatRef<'_, f64>,
        accuracy: BucklingAccuracy,
        mut product: impl FnMut(MatRef<'_, f64>) -> Result<Mat<f64>, E>,
    ) -> Result<f64, E> {
        let size = self.rigid.shapes.nrows();
        check_rows("the displacements to begin with", start.nrows(), size)?;
        // What the given vectors have nothing of, such as the other half of a symmetric body, is in a random one.
        let mut seed = 1;
        let random = self.static_response(self.mass.product(random_block(size, 1, &mut seed).as_ref()).as_ref())?;
        let given = GIVEN.min(start.ncols());
        let mut block = Mat::from_fn(size, given + 1, |i, j| if j < given { start[(i, j)] } else { random[(i, 0)] });
        let (mut basis, mut forces) = (Mat::<f64>::zeros(size, 0), Mat::<f64>::zeros(size, 0));
        let mut lowest = 0.0;
        for round in 0..MAX_BLOCKS {
            let added = self.stiffness_orthonormal(basis.as_ref(), &block);
            if added.ncols() == 0 {
                break;
            }
            let of_added = product(added.as_ref())?;
            let columns = basis.ncols();
            basis.resize_with(size, columns + added.ncols(), |i, j| added[(i, j - columns)]);
            forces.resize_with(size, columns + added.ncols(), |i, j| of_added[(i, j - columns)]);
            let reduced = tall::inner(basis.as_ref(), forces.as_ref());
            let symmetric =
                Mat::from_fn(reduced.nrows(), reduced.ncols(), |i, j| 0.5 * (reduced[(i, j)] + reduced[(j, i)]));
            let (values, _) = symmetric_eigen(&symmetric)?;
            let before = std::mem::replace(&mut lowest, values.iter().copied().fold(0.0, f64::min));
            if round > 0 && (accuracy == BucklingAccuracy::Estimate || (before - lowest) <= SETTLED * -lowest) {
                break;
            }
            block = self.static_response(of_added.as_ref())?;
        }
        Ok(lowest)
    }

    /// The part of the columns that is K-orthogonal to `basis` (K-orthonormal), K-orthonormal.
    fn stiffness_orthonormal(&self, basis: MatRef<'_, f64>, block: &Mat<f64>) -> Mat<f64> {
        let size = block.nrows();
        let mut added = Mat::<f64>::zeros(size, 0);
        for column in 0..block.ncols() {
            let mut vector = block.subcols(column, 1).to_owned();
            let mut whole = 0.0;
            for round in 0..3 {
                let stiff = self.stiffness.product(vector.as_ref());
                let norm = tall::inner(vector.as_ref(), stiff.as_ref())[(0, 0)].max(0.0).sqrt();
                if round == 0 {
                    whole = norm;
                }
                if norm <= DEPENDENT * whole || norm == 0.0 {
                    break;
                }
                if round == 2 {
                    let columns = added.ncols();
                    added.resize_with(size, columns + 1, |i, _| vector[(i, 0)] / norm);
                    break;
                }
                for others in [basis, added.as_ref()] {
                    if others.ncols() > 0 {
                        let parts = tall::inner(others, stiff.as_ref());
                        tall::multiply(vector.as_mut(), Accum::Add, others, parts.as_ref(), -1.0);
                    }
                }
            }
        }
        added
    }
}
