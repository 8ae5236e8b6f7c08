//! Block Lanczos for `(K + sM)⁻¹ M φ = μ φ` in the M-product, away from the rigid modes.
//!
//! The whole basis V is kept and every new block is made M-orthogonal to it twice, so T = Vᵀ M (K + sM)⁻¹ M V is
//! known to rounding and no ghost eigenvalue appears.

use faer::{Mat, MatRef, Side};

use crate::error::ModalError;
use crate::mass::NodalMass;
use crate::shifted::Shifted;

/// Vectors solved for at a time.
const BLOCK: usize = 8;
/// ‖(K + sM)⁻¹Mφ − μφ‖_M / μ of a pair that is accepted.
const TOLERANCE: f64 = 1e-10;
/// Directions of a new block below this, relative to the block before orthogonalisation, are rounding.
const DEPENDENT: f64 = 1e-13;
/// More block steps than this (each mode wanted adds its share) mean that something is wrong.
const SPARE_STEPS: usize = 60;

/// Approximate eigenvectors, M-orthonormal, in falling order of μ.
pub(crate) struct LanczosPairs {
    pub vectors: Mat<f64>,
    /// ‖(K + sM)⁻¹Mφ − μφ‖_M / μ.
    pub residuals: Vec<f64>,
    pub block_solves: usize,
    pub basis_size: usize,
}

/// The `count` pairs with the largest μ that are M-orthogonal to `rigid` (N×6, M-orthonormal).
///
/// `report` is called after each step with the number of pairs that have converged.
pub(crate) fn largest_pairs(
    operator: &Shifted,
    mass: &NodalMass,
    rigid: MatRef<'_, f64>,
    count: usize,
    mut report: impl FnMut(usize),
) -> Result<LanczosPairs, ModalError> {
    let n = rigid.nrows();
    let available = n - rigid.ncols();
    let m_rigid = mass.product(rigid);
    let max_steps = SPARE_STEPS + 2 * count.div_ceil(BLOCK);
    let room = || {
        let mut vectors = Mat::with_capacity(n, available.min(4 * count + 4 * BLOCK));
        vectors.resize_with(n, 0, |_, _| 0.0);
        vectors
    };
    let mut basis = Basis { rigid, m_rigid, vectors: room(), m_vectors: room() };
    // Projection of the operator; row and column blocks grow with the basis.
    let mut projected: Mat<f64> = Mat::zeros(0, 0);
    let mut block_solves = 0;

    let mut seed = 1;
    let mut last = basis.extend(mass, random_block(n, BLOCK.min(available), &mut seed), 0.0)?.columns;
    for step in 1..=max_steps {
        let size = basis.vectors.ncols();
        let mut w = basis.m_vectors.get(.., size - last..).to_owned();
        operator.solve_in_place(w.as_mut())?;
        block_solves += 1;
        let scale = block_norm(mass, &w);
        let extension = basis.extend(mass, w, scale)?;
        // Columns of T for the block that the operator was applied to.
        let mut grown = Mat::zeros(size, size);
        grown.as_mut().submatrix_mut(0, 0, projected.nrows(), projected.ncols()).copy_from(&projected);
        let from = size - last;
        for j in 0..last {
            for i in 0..size {
                grown[(i, from + j)] = extension.coefficients[(i, j)];
                grown[(from + j, i)] = extension.coefficients[(i, j)];
            }
        }
        projected = grown;

        let eigen = projected.self_adjoint_eigen(Side::Lower).map_err(|_| ModalError::DenseEigen { size })?;
        let exhausted = size >= available;
        // faer sorts upwards; the wanted ones are the last.
        let wanted: Vec<usize> = (0..size).rev().take(count).collect();
        let mu: Vec<f64> = wanted.iter().map(|i| eigen.S().column_vector()[*i]).collect();
        let residuals: Vec<f64> = wanted
            .iter()
            .zip(&mu)
            .map(|(i, mu)| {
                let tail = eigen.U().submatrix(from, *i, last, 1);
                (&extension.coupling * tail).norm_l2() / mu.abs()
            })
            .collect();
        let converged = residuals.iter().take_while(|r| **r < TOLERANCE).count();
        report(converged);
        if wanted.len() == count && (converged == count || exhausted) {
            let coefficients = Mat::from_fn(size, count, |i, j| eigen.U()[(i, wanted[j])]);
            let vectors = basis.vectors.get(.., ..size) * &coefficients;
            return Ok(LanczosPairs { vectors, residuals, block_solves, basis_size: size });
        }
        last = extension.columns;
        if last == 0 {
            // The basis spans an invariant subspace: go on from elsewhere, uncoupled from it.
            let fresh = random_block(n, BLOCK.min(available - size), &mut seed);
            last = basis.extend(mass, fresh, 0.0)?.columns;
        }
        if step == max_steps {
            let residual = residuals.iter().copied().fold(0.0, f64::max);
            return Err(ModalError::NotConverged {
                converged,
                requested: count,
                steps: step,
                residual,
                tolerance: TOLERANCE,
            });
        }
    }
    Err(ModalError::NotConverged {
        converged: 0,
        requested: count,
        steps: max_steps,
        residual: f64::INFINITY,
        tolerance: TOLERANCE,
    })
}

/// An M-orthonormal basis beside the rigid modes.
struct Basis<'a> {
    rigid: MatRef<'a, f64>,
    m_rigid: Mat<f64>,
    vectors: Mat<f64>,
    m_vectors: Mat<f64>,
}

/// What a new block looks like in the basis: `W = V·coefficients + Q·coupling`.
struct Extension {
    coefficients: Mat<f64>,
    coupling: Mat<f64>,
    /// Columns of Q that were new.
    columns: usize,
}

impl Basis<'_> {
    /// Makes `w` M-orthogonal to the basis and to the rigid modes, M-orthonormalises it and appends it.
    /// Directions smaller than [`DEPENDENT`]·`scale` are dropped.
    fn extend(&mut self, mass: &NodalMass, mut w: Mat<f64>, scale: f64) -> Result<Extension, ModalError> {
        let width = w.ncols();
        let mut coefficients = Mat::zeros(self.vectors.ncols(), width);
        for _pass in 0..2 {
            w -= self.rigid * (self.m_rigid.transpose() * &w);
            let h = self.m_vectors.transpose() * &w;
            w -= &self.vectors * &h;
            coefficients += h;
        }
        // SVQB, twice: the second pass repairs what the first loses where the block is nearly dependent.
        let (transform, inverse) = orthonormalizer(&w, &mass.product(w.as_ref()), scale)?;
        w = &w * transform;
        let mut coupling = inverse;
        if w.ncols() > 0 {
            w -= self.rigid * (self.m_rigid.transpose() * &w);
            w -= &self.vectors * (self.m_vectors.transpose() * &w);
            let m_w = mass.product(w.as_ref());
            let (transform, inverse) = orthonormalizer(&w, &m_w, 0.0)?;
            w = &w * &transform;
            append(&mut self.m_vectors, &(m_w * transform));
            append(&mut self.vectors, &w);
            coupling = inverse * coupling;
        }
        Ok(Extension { coefficients, coupling, columns: w.ncols() })
    }
}

/// `(S, S⁺)` such that W·S is M-orthonormal and W = (W·S)·S⁺ up to what is dropped.
fn orthonormalizer(w: &Mat<f64>, m_w: &Mat<f64>, scale: f64) -> Result<(Mat<f64>, Mat<f64>), ModalError> {
    let gram = w.transpose() * m_w;
    let size = gram.nrows();
    let norms: Vec<f64> = (0..size).map(|i| gram[(i, i)].max(0.0).sqrt()).collect();
    let unit = |i: usize| if norms[i] > 0.0 { 1.0 / norms[i] } else { 0.0 };
    let scaled = Mat::from_fn(size, size, |i, j| 0.5 * (gram[(i, j)] + gram[(j, i)]) * unit(i) * unit(j));
    let eigen = scaled.self_adjoint_eigen(Side::Lower).map_err(|_| ModalError::DenseEigen { size })?;
    let value = |k: usize| eigen.S().column_vector()[k];
    // A direction counts while its length against the block's is above rounding.
    let length = |k: usize| {
        value(k).max(0.0).sqrt() * (0..size).map(|i| (eigen.U()[(i, k)] * norms[i]).powi(2)).sum::<f64>().sqrt()
    };
    let kept: Vec<usize> = (0..size).filter(|k| value(*k) > 1e-14 && length(*k) > DEPENDENT * scale).collect();
    let transform = Mat::from_fn(size, kept.len(), |i, j| unit(i) * eigen.U()[(i, kept[j])] / value(kept[j]).sqrt());
    let inverse = Mat::from_fn(kept.len(), size, |i, j| value(kept[i]).sqrt() * eigen.U()[(j, kept[i])] * norms[j]);
    Ok((transform, inverse))
}

/// Largest M-norm of the columns.
fn block_norm(mass: &NodalMass, w: &Mat<f64>) -> f64 {
    let m_w = mass.product(w.as_ref());
    (0..w.ncols()).map(|j| (w.col(j).transpose() * m_w.col(j)).max(0.0).sqrt()).fold(0.0, f64::max)
}

/// Puts `right` beside the columns of `left`.
fn append(left: &mut Mat<f64>, right: &Mat<f64>) {
    let columns = left.ncols();
    left.resize_with(left.nrows(), columns + right.ncols(), |i, j| right[(i, j - columns)]);
}

/// Numbers in (−1, 1) from a 64-bit linear congruential generator: the same on every run and machine.
fn random_block(rows: usize, columns: usize, seed: &mut u64) -> Mat<f64> {
    Mat::from_fn(rows, columns, |_, _| {
        *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    })
}
