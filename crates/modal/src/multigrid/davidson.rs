//! The lowest modes by a block Davidson method: Rayleigh–Ritz on a basis that grows by corrections B (K φ − λ M φ), where B is
//! near to K⁻¹ and takes no factor of it.
//!
//! Davidson (1975); with one multigrid cycle for B it takes as many steps for any size of the mesh: Arbenz et al., "A comparison
//! of eigensolvers for large-scale 3D modal analysis using AMG-preconditioned iterative methods" (2005).

use faer::linalg::matmul::matmul;
use faer::reborrow::{Reborrow, ReborrowMut};
use faer::{Accum, ColRef, Mat, MatMut, MatRef, Par, unzip, zip};
use rayon::current_num_threads;
use rayon::prelude::*;

use crate::eigen::lanczos::LanczosPairs;
use crate::eigen::svqb::{Svqb, norms};
use crate::error::ModalError;
use crate::matrix::dense::symmetric_eigen;
use crate::matrix::mass_matrix::MassMatrix;
use crate::matrix::products::{Packed, WIDTH};
use crate::matrix::row_chunks::{row_chunks, row_chunks_mut};
use crate::matrix::stiffness::StiffnessMatrix;
use crate::matrix::tall;
use crate::memory_estimate::{of_vectors, reserve_of_dense_products};
use crate::multigrid::cycle::Multigrid;
use crate::multigrid::no_cycles::NoCycles;

/// √(rᵀBr/λ) of a pair that is accepted: its λ errs by the square.
const TOLERANCE: f64 = 1e-9;
/// In the lowest modes of a slender body, whose λ is far below the largest of the mesh, rounding leaves more than [`TOLERANCE`]. A
/// pair as near as this that comes no nearer in a step has come to that. Twice its residual is then enough for all pairs: the
/// others need not be better than the worst.
const NEAR: f64 = 1e-7;
/// A round leaves a vector orthogonal to the basis to rounding by the inverse of this part, which is left of it at the least, and a
/// block orthonormal to rounding by its inverse square.
const LEFT: f64 = 1e-3;
/// Directions of a block below this are rounding; its Gram matrix is blind below the square of it.
const DEPENDENT: f64 = 1e-7;
/// Rounds of orthogonalisation.
const MAX_ROUNDS: usize = 4;
/// Steps at the most. It takes 14 to 20 of one material on compact elements, 30 to 40 of a core of plastic in a shell of steel or
/// of elements five times as long as thick.
const MAX_STEPS: usize = 48;
/// Steps after which the convergence is judged.
const FIRST_STEPS: usize = 8;
/// Steps that the basis has room for after a restart.
const STEPS_IN_ROOM: usize = 5;
/// Rows that one task computes.
const ROWS: usize = 4096;

/// The `count` pairs with the lowest λ that are M-orthogonal to `rigid`, from the vectors of `start` on.
///
/// `report` is called after each step with how far it has come, as a number of pairs.
pub(crate) fn lowest_pairs(
    stiffness: StiffnessMatrix<'_>,
    mass: &MassMatrix<'_>,
    rigid: MatRef<'_, f64>,
    multigrid: &mut Multigrid<'_>,
    start: Mat<f64>,
    count: usize,
    mut report: impl FnMut(usize),
) -> Result<LanczosPairs, NoCycles> {
    let mut search = Search::new(stiffness, mass, rigid, count)?;
    for first in (0..start.ncols()).step_by(count) {
        let columns = start.subcols(first, count.min(start.ncols() - first));
        search.next(columns.ncols()).copy_from(columns);
        search.extend(columns.ncols())?;
    }
    drop(start);
    // Coefficients of the pairs a step ago.
    let mut before: Mat<f64> = Mat::zeros(0, 0);
    let mut residuals = vec![f64::INFINITY; count];
    let mut tolerance = TOLERANCE;
    for step in 1..=MAX_STEPS {
        let (mut eigenvalues, mut coefficients) = symmetric_eigen(&search.projected)?;
        if eigenvalues.len() < count {
            return Err(NoCycles::NotConverged { steps: step });
        }
        // Those that have converged wait for the others: what is kept of the basis has them.
        let open: Vec<usize> = (0..count).filter(|k| residuals[*k] > tolerance).collect();
        if search.size + open.len() > room(count) {
            search.restart(&coefficients, &before)?;
            (eigenvalues, coefficients) = symmetric_eigen(&search.projected)?;
        }
        let lambdas: Vec<f64> = open.iter().map(|k| eigenvalues[*k]).collect();
        let of_open = Mat::from_fn(coefficients.nrows(), open.len(), |i, k| coefficients[(i, open[k])]);
        let squared = search.correct(&lambdas, of_open.as_ref(), multigrid);
        // B is positive; where it is not, it is no help.
        if !squared.iter().all(|squared| *squared >= 0.0) {
            return Err(NoCycles::NotConverged { steps: step });
        }
        for (k, squared) in open.iter().zip(squared) {
            let residual = squared.sqrt();
            if (residuals[*k]..=NEAR).contains(&residual) {
                tolerance = tolerance.max(2.0 * residual);
            }
            residuals[*k] = residual;
        }

        // All pairs come nearer together: the digits that are found tell how far they have come.
        let found = residuals.iter().map(|residual| (residual.ln() / tolerance.ln()).clamp(0.0, 1.0)).sum::<f64>();
        report(found as usize);
        let is_found = residuals.iter().all(|residual| *residual <= tolerance);
        if is_found && open.len() < count {
            // A pair that was found late has moved the others on: all are looked at together.
            residuals.fill(f64::INFINITY);
            continue;
        }
        if is_found {
            let basis_size = search.most;
            let vectors = product(search.basis(), coefficients.subcols(0, count));
            return Ok(LanczosPairs { vectors, residuals, block_solves: step, basis_size });
        }
        if step >= FIRST_STEPS && found * (MAX_STEPS as f64) < (count * step) as f64 {
            return Err(NoCycles::NotConverged { steps: step });
        }
        let still: Vec<usize> = (0..open.len()).filter(|k| residuals[open[*k]] > tolerance).collect();
        let mut next = search.next(open.len());
        for (to, from) in still.iter().enumerate().filter(|(to, from)| to < *from) {
            let (left, right) = next.rb_mut().split_at_col_mut(*from);
            left.col_mut(to).copy_from(right.col(0));
        }
        if search.extend(still.len())? == 0 {
            return Err(NoCycles::NotConverged { steps: step });
        }
        before = coefficients.subcols(0, count).to_owned();
    }
    Err(NoCycles::NotConverged { steps: MAX_STEPS })
}

/// Vectors that a search for `count` pairs has room for.
pub(crate) fn room(count: usize) -> usize {
    start(count) + (STEPS_IN_ROOM + 1) * count
}

/// Vectors beside the basis: shapes, their products with K and M, those that it begins with or finds, and a packed block.
pub(crate) fn beside(count: usize) -> usize {
    3 * count + start(count) + WIDTH
}

/// Vectors that a search for `count` pairs begins with, and is left with at a restart.
pub(crate) fn start(count: usize) -> usize {
    count + count / 2 + 8
}

/// A basis, M-orthonormal and M-orthogonal to the rigid modes, and what is done with it.
struct Search<'a> {
    stiffness: StiffnessMatrix<'a>,
    mass: &'a MassMatrix<'a>,
    rigid: usize,
    /// The rigid modes, the basis, and room for more of it.
    columns: Mat<f64>,
    size: usize,
    /// The largest size that it had.
    most: usize,
    /// Vᵀ K V.
    projected: Mat<f64>,
    shapes: Mat<f64>,
    forces: Mat<f64>,
    momenta: Mat<f64>,
    packed: Vec<Packed>,
}

impl<'a> Search<'a> {
    fn new(
        stiffness: StiffnessMatrix<'a>,
        mass: &'a MassMatrix<'a>,
        rigid: MatRef<'_, f64>,
        count: usize,
    ) -> Result<Self, ModalError> {
        let (rows, fixed) = (rigid.nrows(), rigid.ncols());
        let (needed, reserve) =
            (of_vectors(rows, fixed + room(count) + beside(count)), reserve_of_dense_products(current_num_threads()));
        memory::check_with_reserve("the search for modes", needed, reserve)?;
        let mut columns = Mat::zeros(rows, fixed + room(count));
        columns.as_mut().subcols_mut(0, fixed).copy_from(rigid);
        let zeros = || Mat::zeros(rows, count);
        let (shapes, forces, momenta) = (zeros(), zeros(), zeros());
        let (projected, packed) = (Mat::zeros(0, 0), Vec::new());
        Ok(Self {
            stiffness,
            mass,
            rigid: fixed,
            columns,
            size: 0,
            most: 0,
            projected,
            shapes,
            forces,
            momenta,
            packed,
        })
    }

    fn basis(&self) -> MatRef<'_, f64> {
        self.columns.subcols(self.rigid, self.size)
    }

    /// The place of the next `count` vectors.
    fn next(&mut self, count: usize) -> MatMut<'_, f64> {
        self.columns.as_mut().subcols_mut(self.rigid + self.size, count)
    }

    /// Makes `B (K φ − λ M φ)` of shapes φ with these coefficients the next vectors. Returns rᵀBr/λ of each.
    fn correct(&mut self, lambdas: &[f64], coefficients: MatRef<'_, f64>, multigrid: &mut Multigrid<'_>) -> Vec<f64> {
        let Self { stiffness, mass, columns, shapes, forces, momenta, packed, .. } = self;
        let (basis, next) =
            columns.as_mut().subcols_mut(self.rigid, self.size + lambdas.len()).split_at_col_mut(self.size);
        let [mut shapes, mut forces, mut momenta] =
            [shapes, forces, momenta].map(|block| block.as_mut().subcols_mut(0, lambdas.len()));
        multiply(shapes.rb_mut(), Accum::Replace, basis.rb(), coefficients, 1.0);
        stiffness.product_into(shapes.rb(), forces.rb_mut(), packed);
        mass.product_into(shapes.rb(), momenta.rb_mut(), packed);
        for (lambda, (force, momentum)) in
            lambdas.iter().zip(forces.rb_mut().col_iter_mut().zip(momenta.rb().col_iter()))
        {
            zip!(force, momentum).for_each(|unzip!(force, m)| *force -= lambda * m);
        }
        let mut next = next;
        next.copy_from(&forces);
        multigrid.apply(next.rb_mut());
        let squared = |(lambda, (force, correction)): (&f64, (ColRef<'_, f64>, ColRef<'_, f64>))| {
            force.transpose() * correction / lambda
        };
        lambdas.iter().zip(forces.rb().col_iter().zip(next.rb().col_iter())).map(squared).collect()
    }

    /// Takes the next vectors in: M-orthogonal to the basis and M-orthonormal, without those that are rounding. Returns how many
    /// there are; none where they do not become orthonormal.
    fn extend(&mut self, count: usize) -> Result<usize, ModalError> {
        let Self { stiffness, mass, columns, forces, momenta, packed, .. } = self;
        let known = self.rigid + self.size;
        let (all, mut new) = columns.as_mut().subcols_mut(0, known + count).split_at_col_mut(known);
        let mut width = count;
        let mut is_done = false;
        for _ in 0..MAX_ROUNDS {
            let mut block = new.rb_mut().subcols_mut(0, width);
            let mut momenta = momenta.as_mut().subcols_mut(0, width);
            mass.product_into(block.rb(), momenta.rb_mut(), packed);
            let along = inner(all.rb(), momenta.rb());
            multiply(block.rb_mut(), Accum::Add, all.rb(), along.as_ref(), -1.0);
            mass.product_into(block.rb(), momenta.rb_mut(), packed);
            let gram = inner(block.rb(), momenta.rb());
            let part = |(k, left): (usize, f64)| left / left.hypot(along.col(k).norm_l2());
            let is_left = norms(&gram).into_iter().enumerate().map(part).all(|part| part > LEFT);
            let Svqb { transform, well_conditioned, .. } = orthonormal(&gram)?;
            combine(block, transform.as_ref());
            width = transform.ncols();
            is_done = is_left && well_conditioned;
            if width == 0 || is_done {
                break;
            }
        }
        if !is_done {
            return Ok(0);
        }
        let mut forces = forces.as_mut().subcols_mut(0, width);
        stiffness.product_into(new.rb().subcols(0, width), forces.rb_mut(), packed);
        self.size += width;
        self.most = self.most.max(self.size);
        let basis = self.columns.subcols(self.rigid, self.size);
        self.projected = grown(&self.projected, &inner(basis, self.forces.subcols(0, width)));
        Ok(width)
    }

    /// Leaves of the basis the lowest pairs, of which these are the coefficients, and the pairs of the step before: the way
    /// that they go is not lost (Stathopoulos and Saad 1998).
    fn restart(&mut self, coefficients: &Mat<f64>, before: &Mat<f64>) -> Result<(), ModalError> {
        let lowest = coefficients.subcols(0, start(before.ncols()).min(coefficients.ncols()));
        let mut last = Mat::zeros(self.size, before.ncols());
        last.as_mut().subrows_mut(0, before.nrows()).copy_from(before);
        for _ in 0..2 {
            let along = inner(lowest, last.as_ref());
            multiply(last.as_mut(), Accum::Add, lowest, along.as_ref(), -1.0);
            let Svqb { transform, .. } = orthonormal(&inner(last.as_ref(), last.as_ref()))?;
            last = product(last.as_ref(), transform.as_ref());
        }
        let kept = tall::side_by_side(&[lowest, last.as_ref()]);
        let projected = product(self.projected.as_ref(), kept.as_ref());
        self.projected = inner(kept.as_ref(), projected.as_ref());
        combine(self.columns.as_mut().subcols_mut(self.rigid, self.size), kept.as_ref());
        self.size = kept.ncols();
        Ok(())
    }
}

/// The projection with the rows and columns of new vectors, the last ones.
fn grown(projected: &Mat<f64>, new: &Mat<f64>) -> Mat<f64> {
    let from = projected.nrows();
    let entry = |i: usize, j: usize| match (i.min(j), i.max(j)) {
        (row, column) if row >= from => 0.5 * (new[(row, column - from)] + new[(column, row - from)]),
        (row, column) if column >= from => new[(row, column - from)],
        _ => projected[(i, j)],
    };
    Mat::from_fn(new.nrows(), new.nrows(), entry)
}

/// X·H in the first columns of X.
fn combine(x: MatMut<'_, f64>, h: MatRef<'_, f64>) {
    row_chunks_mut(x, ROWS).for_each(|x| {
        let mut combined = Mat::zeros(x.nrows(), h.ncols());
        matmul(combined.as_mut(), Accum::Replace, x.rb(), h, 1.0, Par::Seq);
        x.subcols_mut(0, h.ncols()).copy_from(combined);
    });
}

/// Transformation that makes a block with this Gram matrix orthonormal, without its part of rounding.
fn orthonormal(gram: &Mat<f64>) -> Result<Svqb, ModalError> {
    Svqb::new(gram, &norms(gram), LEFT * LEFT, |value, _| value > DEPENDENT * DEPENDENT)
}

/// AᵀB. As with [`tall`], rows are cut at fixed places, so that the result is the same for any number of threads; these products
/// are of large blocks, for which faer's are faster.
fn inner(a: MatRef<'_, f64>, b: MatRef<'_, f64>) -> Mat<f64> {
    let zero = || Mat::zeros(a.ncols(), b.ncols());
    let of_rows = |(a, b): (MatRef<'_, f64>, MatRef<'_, f64>)| {
        let mut c = zero();
        matmul(c.as_mut(), Accum::Replace, a.transpose(), b, 1.0, Par::Seq);
        c
    };
    let parts: Vec<Mat<f64>> = row_chunks(a, ROWS).zip(row_chunks(b, ROWS)).map(of_rows).collect();
    parts.into_iter().fold(zero(), |sum, part| sum + part)
}

/// Y = A·H, or Y += `factor`·A·H.
fn multiply(y: MatMut<'_, f64>, beta: Accum, a: MatRef<'_, f64>, h: MatRef<'_, f64>, factor: f64) {
    let of_rows = |(y, a): (MatMut<'_, f64>, MatRef<'_, f64>)| matmul(y, beta, a, h, factor, Par::Seq);
    row_chunks_mut(y, ROWS).zip(row_chunks(a, ROWS)).for_each(of_rows);
}

/// A·H.
fn product(a: MatRef<'_, f64>, h: MatRef<'_, f64>) -> Mat<f64> {
    let mut y = Mat::zeros(a.nrows(), h.ncols());
    multiply(y.as_mut(), Accum::Replace, a, h, 1.0);
    y
}
