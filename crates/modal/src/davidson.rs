//! The lowest modes by a block Davidson method: Rayleigh–Ritz on a basis that grows by corrections B (K φ − λ M φ), where B is
//! near to K⁻¹ and takes no factor of it.
//!
//! Davidson (1975); with one multigrid cycle for B it takes as many steps for any size of the mesh: Arbenz et al., "A comparison
//! of eigensolvers for large-scale 3D modal analysis using AMG-preconditioned iterative methods" (2005).

use faer::{Accum, Mat, MatRef};

use crate::dense::symmetric_eigen;
use crate::error::ModalError;
use crate::lanczos::{Basis, LanczosPairs, views};
use crate::mass_matrix::MassMatrix;
use crate::multigrid::Multigrid;
use crate::stiffness::StiffnessMatrix;
use crate::tall;

/// √(rᵀBr/λ) of a pair that is accepted: its λ errs by the square.
const TOLERANCE: f64 = 1e-9;
/// Steps at the most, and those after which it is seen how the residuals fall.
const MAX_STEPS: usize = 40;
const TRIAL_STEPS: usize = 5;
/// Where a step makes them smaller by less than this, elements are flat or the body nearly incompressible, and the factor of
/// K + sM takes less time.
const LEAST_GAIN: f64 = 0.5;

/// The `count` pairs with the lowest λ that are M-orthogonal to `rigid`, from the vectors of `start` on, or none where it
/// would take too long.
///
/// `report` is called after each step with the number of pairs that have converged.
pub(crate) fn lowest_pairs(
    stiffness: StiffnessMatrix<'_>,
    mass: &MassMatrix<'_>,
    rigid: MatRef<'_, f64>,
    multigrid: &mut Multigrid<'_>,
    start: Mat<f64>,
    count: usize,
    mut report: impl FnMut(usize),
) -> Result<Option<LanczosPairs>, ModalError> {
    let mut basis = Basis::new(mass, rigid, room(count))?;
    let mut projected: Mat<f64> = Mat::zeros(0, 0);
    let mut block = start;
    let mut residuals = vec![f64::INFINITY; count];
    let (mut worst, mut block_solves, mut packed) = (Vec::new(), 0, Vec::new());
    for _ in 0..MAX_STEPS {
        let from = basis.size();
        let added = basis.extend(block, 0)?.columns;
        let vectors = views(&basis.blocks[1..]);
        let stiff = match vectors.last() {
            Some(last) => stiffness.product(*last),
            None => return Ok(None),
        };
        projected = grown(&projected, &tall::inner_of_blocks(&vectors, stiff.as_ref()), from);
        let (eigenvalues, coefficients) = symmetric_eigen(&projected)?;
        if eigenvalues.len() < count || added == 0 {
            return Ok(None);
        }

        // Those that have converged stay so: the basis only grows.
        let open: Vec<usize> = (0..count).filter(|k| residuals[*k] > TOLERANCE).collect();
        let of_open = Mat::from_fn(coefficients.nrows(), open.len(), |i, k| coefficients[(i, open[k])]);
        let mut shapes = Mat::zeros(rigid.nrows(), open.len());
        tall::multiply_blocks(shapes.as_mut(), Accum::Replace, &vectors, of_open.as_ref(), 1.0);
        let mut forces = stiffness.product(shapes.as_ref());
        let mut momenta = stiff;
        momenta.resize_with(shapes.nrows(), shapes.ncols(), |_, _| 0.0);
        mass.product_into(shapes.as_ref(), momenta.as_mut(), &mut packed);
        for (k, (force, momentum)) in open.iter().zip(forces.col_iter_mut().zip(momenta.col_iter())) {
            force.iter_mut().zip(momentum.iter()).for_each(|(force, m)| *force -= eigenvalues[*k] * m);
        }
        let mut corrections = forces.clone();
        multigrid.apply(corrections.as_mut());
        block_solves += 1;
        for (k, (force, correction)) in open.iter().zip(forces.col_iter().zip(corrections.col_iter())) {
            residuals[*k] = ((force.transpose() * correction).max(0.0) / eigenvalues[*k]).sqrt();
        }

        let converged = residuals.iter().filter(|residual| **residual <= TOLERANCE).count();
        report(converged);
        if converged == count {
            let basis_size = basis.size();
            let vectors = basis.combine(coefficients.subcols(0, count));
            return Ok(Some(LanczosPairs { vectors, residuals, block_solves, basis_size }));
        }
        worst.push(residuals.iter().copied().fold(0.0, f64::max));
        if is_slow(&worst) {
            return Ok(None);
        }
        let still: Vec<usize> = (0..open.len()).filter(|k| residuals[open[*k]] > TOLERANCE).collect();
        block = Mat::from_fn(corrections.nrows(), still.len(), |i, k| corrections[(i, still[k])]);
    }
    Ok(None)
}

/// Vectors that a search for `count` pairs has room for.
pub(crate) fn room(count: usize) -> usize {
    20 * count
}

/// Whether the largest residuals of the steps fall too slowly.
fn is_slow(worst: &[f64]) -> bool {
    match (worst.len().checked_sub(TRIAL_STEPS).and_then(|first| worst.get(first)), worst.last()) {
        (Some(first), Some(last)) if worst.len() > TRIAL_STEPS => last / first > LEAST_GAIN.powi(TRIAL_STEPS as i32 - 1),
        _ => false,
    }
}

/// The projection with rows and columns of new vectors, from the number `from` on.
fn grown(projected: &Mat<f64>, new: &Mat<f64>, from: usize) -> Mat<f64> {
    let entry = |i: usize, j: usize| match (i.min(j), i.max(j)) {
        (row, column) if column >= from && row >= from => {
            0.5 * (new[(row, column - from)] + new[(column, row - from)])
        }
        (row, column) if column >= from => new[(row, column - from)],
        _ => projected[(i, j)],
    };
    Mat::from_fn(new.nrows(), new.nrows(), entry)
}
