//! The lowest modes by a block Davidson method: Rayleigh–Ritz on a basis that grows by corrections B (K φ − λ M φ), where B is
//! near to K⁻¹ and takes no factor of it.
//!
//! Davidson (1975); with one multigrid cycle for B it takes as many steps for any size of the mesh: Arbenz et al., "A comparison
//! of eigensolvers for large-scale 3D modal analysis using AMG-preconditioned iterative methods" (2005).

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, MatRef, Par};

use crate::dense::symmetric_eigen;
use crate::error::ModalError;
use crate::foretold::of_vectors;
use crate::lanczos::LanczosPairs;
use crate::mass_matrix::MassMatrix;
use crate::multigrid::Multigrid;
use crate::products::Packed;
use crate::stiffness::StiffnessMatrix;

/// √(rᵀBr/λ) of a pair that is accepted: its λ errs by the square.
const TOLERANCE: f64 = 1e-9;
/// What is left of a vector beside the basis is orthogonal to it, to rounding by the inverse of this part.
const LEFT: f64 = 1e-3;
/// Directions of a block below this are rounding; its Gram matrix is blind below the square of it.
const DEPENDENT: f64 = 1e-7;
/// Rounds of orthogonalisation.
const MAX_ROUNDS: usize = 4;

/// The `count` pairs with the lowest λ that are M-orthogonal to `rigid`, from the vectors of `start` on, or none where a basis
/// of [`room`] vectors does not hold them.
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
    let mut block_solves = 0;
    while basis.size() + block.ncols() <= room(count) {
        let from = basis.size();
        if basis.extend(block)? == 0 {
            return Ok(None);
        }
        let new = basis.vectors().subcols(from, basis.size() - from);
        projected = grown(&projected, &inner(basis.vectors(), stiffness.product(new).as_ref()), from);
        let (eigenvalues, coefficients) = symmetric_eigen(&projected)?;
        if eigenvalues.len() < count {
            return Ok(None);
        }

        // Those that have converged stay so: the basis only grows.
        let open: Vec<usize> = (0..count).filter(|k| residuals[*k] > TOLERANCE).collect();
        let of_open = Mat::from_fn(coefficients.nrows(), open.len(), |i, k| coefficients[(i, open[k])]);
        let shapes = product(basis.vectors(), of_open.as_ref());
        let mut forces = stiffness.product(shapes.as_ref());
        let momenta = mass.product(shapes.as_ref());
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
            let vectors = product(basis.vectors(), coefficients.subcols(0, count));
            return Ok(Some(LanczosPairs { vectors, residuals, block_solves, basis_size }));
        }
        let still: Vec<usize> = (0..open.len()).filter(|k| residuals[open[*k]] > TOLERANCE).collect();
        block = Mat::from_fn(corrections.nrows(), still.len(), |i, k| corrections[(i, still[k])]);
    }
    Ok(None)
}

/// Vectors that a search for `count` pairs has room for.
pub(crate) fn room(count: usize) -> usize {
    start(count) + 20 * count
}

/// Vectors beside the basis: a block, its products with K and M, the corrections and two blocks of scratch.
pub(crate) fn beside(count: usize) -> usize {
    6 * start(count)
}

/// Vectors that a search for `count` pairs begins with.
pub(crate) fn start(count: usize) -> usize {
    count + count / 2 + 8
}

/// The projection with rows and columns of new vectors, from the number `from` on.
fn grown(projected: &Mat<f64>, new: &Mat<f64>, from: usize) -> Mat<f64> {
    let entry = |i: usize, j: usize| match (i.min(j), i.max(j)) {
        (row, column) if row >= from => 0.5 * (new[(row, column - from)] + new[(column, row - from)]),
        (row, column) if column >= from => new[(row, column - from)],
        _ => projected[(i, j)],
    };
    Mat::from_fn(new.nrows(), new.nrows(), entry)
}

/// An M-orthonormal basis, M-orthogonal to the rigid modes, which come before it.
struct Basis<'a> {
    mass: &'a MassMatrix<'a>,
    rigid: usize,
    /// Rigid modes and vectors, and room for more.
    columns: Mat<f64>,
    size: usize,
    packed: Vec<Packed>,
}

impl<'a> Basis<'a> {
    fn new(mass: &'a MassMatrix<'a>, rigid: MatRef<'_, f64>, room: usize) -> Result<Self, ModalError> {
        let count = rigid.ncols();
        memory::check("the search for modes", of_vectors(rigid.nrows(), count + room))?;
        let mut columns = Mat::zeros(rigid.nrows(), count + room);
        columns.as_mut().subcols_mut(0, count).copy_from(rigid);
        Ok(Self { mass, rigid: count, columns, size: 0, packed: Vec::new() })
    }

    fn size(&self) -> usize {
        self.size
    }

    fn vectors(&self) -> MatRef<'_, f64> {
        self.columns.subcols(self.rigid, self.size)
    }

    /// Makes a block M-orthogonal to the basis and M-orthonormal, and appends what is new in it: so many vectors.
    fn extend(&mut self, mut block: Mat<f64>) -> Result<usize, ModalError> {
        let mut momenta = Mat::zeros(block.nrows(), block.ncols());
        for _ in 0..MAX_ROUNDS {
            let all = self.columns.subcols(0, self.rigid + self.size);
            self.mass.product_into(block.as_ref(), momenta.as_mut(), &mut self.packed);
            let along = inner(all, momenta.as_ref());
            add_product(block.as_mut(), all, along.as_ref(), -1.0);
            self.mass.product_into(block.as_ref(), momenta.as_mut(), &mut self.packed);
            let gram = inner(block.as_ref(), momenta.as_ref());
            let left = |k: usize| gram[(k, k)].max(0.0).sqrt();
            let part = |k: usize| left(k) / left(k).hypot(along.col(k).norm_l2());
            let is_left = (0..block.ncols()).all(|k| part(k) > LEFT);
            let (transform, is_independent) = orthonormal(&gram)?;
            block = product(block.as_ref(), transform.as_ref());
            momenta.resize_with(block.nrows(), block.ncols(), |_, _| 0.0);
            if block.ncols() == 0 || is_left && is_independent {
                break;
            }
        }
        let place = self.rigid + self.size;
        self.columns.as_mut().subcols_mut(place, block.ncols()).copy_from(&block);
        self.size += block.ncols();
        Ok(block.ncols())
    }
}

/// What makes a block with this Gram matrix orthonormal, without what is rounding in it; and whether none of it is near to that.
fn orthonormal(gram: &Mat<f64>) -> Result<(Mat<f64>, bool), ModalError> {
    let count = gram.nrows();
    let unit = |k: usize| if gram[(k, k)] > 0.0 { 1.0 / gram[(k, k)].sqrt() } else { 0.0 };
    let scaled = Mat::from_fn(count, count, |i, j| 0.5 * (gram[(i, j)] + gram[(j, i)]) * unit(i) * unit(j));
    let (values, vectors) = symmetric_eigen(&scaled)?;
    let kept: Vec<usize> = (0..count).filter(|k| values[*k] > DEPENDENT * DEPENDENT).collect();
    let transform = Mat::from_fn(count, kept.len(), |i, k| unit(i) * vectors[(i, kept[k])] / values[kept[k]].sqrt());
    Ok((transform, kept.iter().all(|k| values[*k] > LEFT * LEFT)))
}

/// AᵀB.
fn inner(a: MatRef<'_, f64>, b: MatRef<'_, f64>) -> Mat<f64> {
    let mut c = Mat::zeros(a.ncols(), b.ncols());
    matmul(c.as_mut(), Accum::Replace, a.transpose(), b, 1.0, parallel());
    c
}

/// A·H.
fn product(a: MatRef<'_, f64>, h: MatRef<'_, f64>) -> Mat<f64> {
    let mut y = Mat::zeros(a.nrows(), h.ncols());
    matmul(y.as_mut(), Accum::Replace, a, h, 1.0, parallel());
    y
}

/// Y += factor·A·H.
fn add_product(y: MatMut<'_, f64>, a: MatRef<'_, f64>, h: MatRef<'_, f64>, factor: f64) {
    matmul(y, Accum::Add, a, h, factor, parallel());
}

fn parallel() -> Par {
    match rayon::current_num_threads() {
        1 => Par::Seq,
        threads => Par::rayon(threads),
    }
}
