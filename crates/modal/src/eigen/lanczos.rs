//! Block Lanczos for `(K + sM)⁻¹ M φ = μ φ` in the M-product, away from the rigid modes.
//!
//! The whole basis V is kept and every new block is made M-orthogonal to all of it, after it was made so to the last two
//! blocks, so T = Vᵀ M (K + sM)⁻¹ M V is known nearly to rounding and no ghost eigenvalue appears.

use std::collections::VecDeque;

use faer::{Accum, Mat, MatRef};

use crate::eigen::svqb::{Svqb, norms};
use crate::error::ModalError;
use crate::factor::shifted::{Inverted, Shifted, SolveScratch};
use crate::matrix::dense::symmetric_eigen;
use crate::matrix::mass_matrix::MassMatrix;
use crate::matrix::products::Packed;
use crate::matrix::tall;
use crate::memory_estimate::of_vectors;

/// Columns of the rigid modes, zero for those that are missing.
pub(crate) const FIXED: usize = 6;
/// Vectors solved for at a time.
pub(crate) const BLOCK: usize = 8;
/// ‖(K + sM)⁻¹Mφ − μφ‖_M / μ of a pair that is accepted.
const TOLERANCE: f64 = 1e-10;
/// The same at the most where masses differ so much that rounding leaves more: eigenvalues err with its square.
const LARGEST_TOLERANCE: f64 = 1e-6;
/// The last blocks that a new one has parts along.
const NEAR: usize = 2;
/// Directions of a new block below this, relative to the block before orthogonalisation, are rounding.
const DEPENDENT: f64 = 1e-13;
/// Where all eigenvalues of the Gram matrix of a new block, scaled to a unit diagonal, are above this, one round leaves it
/// orthonormal to 2e-12, which is enough for the residuals that are asked for.
const INDEPENDENT: f64 = 1e-4;
/// A round that takes out less than this of a block leaves no more than rounding: the next would take out as small a part
/// of that.
const SETTLED: f64 = 1e-6;
/// Rounds of orthogonalisation: one or two as a rule, a third where directions had to be stretched.
const MAX_ROUNDS: usize = 4;
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

/// The `count` pairs with the largest μ, of `available`, that are M-orthogonal to `rigid` (N×6, M-orthonormal or zero).
///
/// `report` is called after each step with the number of pairs that have converged.
pub(crate) fn largest_pairs(
    factor: &Shifted,
    mass: &MassMatrix<'_>,
    rigid: MatRef<'_, f64>,
    count: usize,
    available: usize,
    report: impl FnMut(usize),
) -> Result<LanczosPairs, ModalError> {
    // In the factor's order neighbours are near to each other in memory, which the products with M want, too.
    if let MassMatrix::Nodal(nodal) = mass
        && let Some((order, inverted)) = factor.in_own_order()
    {
        let vectors = rigid.ncols() + factor.constraints.motion_count();
        memory::check("the search in the order of the factor", mass.bytes() + of_vectors(rigid.nrows(), vectors))?;
        let mass = order.mass(nodal);
        let (mass, rigid) = (MassMatrix::Nodal(mass.as_mass()), order.rows(rigid));
        let mut pairs = search(&inverted, &mass, rigid.as_ref(), count, available, report)?;
        order.restore(&mut pairs.vectors);
        return Ok(pairs);
    }
    search(&factor.in_order_of_nodes(), mass, rigid, count, available, report)
}

/// The same, with all rows in the same order.
fn search(
    operator: &Inverted<'_>,
    mass: &MassMatrix<'_>,
    rigid: MatRef<'_, f64>,
    count: usize,
    available: usize,
    mut report: impl FnMut(usize),
) -> Result<LanczosPairs, ModalError> {
    let n = rigid.nrows();
    let max_steps = SPARE_STEPS + 2 * count.div_ceil(BLOCK);
    let mut scratch = operator.solve_scratch(BLOCK)?;
    let mut basis = Basis::new(mass, rigid, room(count, available))?;
    // Projection of the operator; row and column blocks grow with the basis.
    let mut projected: Mat<f64> = Mat::zeros(0, 0);

    let mut seed = 1;
    let mut begin = |columns: usize, scratch: &mut SolveScratch| {
        let mut block = random_block(n, columns, &mut seed);
        operator.constraints.project(block.as_mut());
        if let MassMatrix::General(_) = mass {
            // Motions without mass, which a random block has parts of, are no part of any mode.
            block = mass.product(block.as_ref());
            operator.solve_in_place(block.as_mut(), scratch);
        }
        block
    };
    let w = begin(BLOCK.min(available), &mut scratch);
    let mut last = basis.extend(w, 0)?.columns;
    let mut near = 1;
    let mut failed = ModalError::NotConverged {
        converged: 0,
        requested: count,
        steps: 0,
        residual: f64::INFINITY,
        tolerance: TOLERANCE,
    };
    for block_solves in 1..=max_steps {
        let size = basis.size();
        let mut w = basis.last_times_mass();
        operator.solve_in_place(w.as_mut(), &mut scratch);
        let extension = basis.extend(w, near)?;
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

        let (eigenvalues, eigenvectors) = symmetric_eigen(&projected)?;
        let exhausted = size >= available;
        // The wanted ones are the last.
        let wanted: Vec<usize> = (0..size).rev().take(count).collect();
        let mu: Vec<f64> = wanted.iter().map(|i| eigenvalues[*i]).collect();
        let residuals: Vec<f64> = wanted
            .iter()
            .zip(&mu)
            .map(|(i, mu)| {
                let tail = eigenvectors.submatrix(from, *i, last, 1);
                (&extension.coupling * tail).norm_l2() / mu.abs()
            })
            .collect();
        // No residual falls below what rounding leaves in the operator's answers, as a rule far less than is asked for.
        let is_rough = mu.first().is_some_and(|mu| basis.rounding > TOLERANCE * mu);
        let rounding = if is_rough { basis.rounding } else { 0.0 };
        let tolerance = |mu: f64| (rounding / mu.abs()).clamp(TOLERANCE, LARGEST_TOLERANCE);
        let converged = residuals.iter().zip(&mu).take_while(|(residual, mu)| **residual < tolerance(**mu)).count();
        report(converged);
        if wanted.len() == count && (converged == count || exhausted) {
            let coefficients = Mat::from_fn(size, count, |i, j| eigenvectors[(i, wanted[j])]);
            drop(scratch);
            let vectors = basis.combine(coefficients.as_ref());
            return Ok(LanczosPairs { vectors, residuals, block_solves, basis_size: size });
        }
        failed = ModalError::NotConverged {
            converged,
            requested: count,
            steps: block_solves,
            residual: residuals.iter().copied().fold(0.0, f64::max),
            tolerance: mu.last().map_or(TOLERANCE, |mu| tolerance(*mu)),
        };
        let mut is_orthonormal = extension.is_orthonormal;
        (near, last) = (NEAR, extension.columns);
        if last == 0 {
            // The basis spans an invariant subspace: go on from elsewhere, uncoupled from it.
            let begun = basis.extend(begin(BLOCK.min(available - size), &mut scratch), 0)?;
            is_orthonormal &= begun.is_orthonormal;
            (near, last) = (1, begun.columns);
        }
        if !is_orthonormal {
            break;
        }
    }
    Err(failed)
}

/// Vectors that a search for `count` of the `available` ones has room for.
pub(crate) fn room(count: usize, available: usize) -> usize {
    available.min(2 * count + 8 * BLOCK)
}

/// An M-orthonormal basis, block by block: the rigid modes, which the search stays away from, then a block for each step.
///
/// M times the basis is kept of few blocks only: another product with M takes less time than that memory.
struct Basis<'a> {
    mass: &'a MassMatrix<'a>,
    blocks: Vec<Mat<f64>>,
    /// M times the rigid modes.
    m_rigid: Mat<f64>,
    /// M times the last [`NEAR`] blocks.
    m_near: VecDeque<Mat<f64>>,
    /// The largest part along the basis that blocks had after those along the last ones were taken out.
    rounding: f64,
    // Scratch of a block's size, used again for each block.
    m_w: Mat<f64>,
    packed: Vec<Packed>,
}

/// A new block in terms of the basis: `W = V·coefficients + Q·coupling`.
struct Extension {
    coefficients: Mat<f64>,
    coupling: Mat<f64>,
    /// Columns of Q that were new.
    columns: usize,
    /// True if Q is M-orthonormal: not where little but rounding was left of W.
    is_orthonormal: bool,
}

impl<'a> Basis<'a> {
    fn new(mass: &'a MassMatrix<'a>, rigid: MatRef<'_, f64>, room: usize) -> Result<Self, ModalError> {
        check_memory(rigid.nrows(), 2 * FIXED + room + 6 * BLOCK)?;
        Ok(Self {
            mass,
            blocks: vec![rigid.to_owned()],
            m_rigid: mass.product(rigid),
            m_near: VecDeque::new(),
            rounding: 0.0,
            m_w: Mat::new(),
            packed: Vec::new(),
        })
    }

    /// Vectors beside the rigid modes.
    fn size(&self) -> usize {
        columns(&self.blocks[1..])
    }

    /// M times the last block.
    fn last_times_mass(&self) -> Mat<f64> {
        self.m_near.back().map_or_else(Mat::new, Mat::clone)
    }

    /// The vectors of the basis times `coefficients`, without what rounding has left of the rigid modes in that.
    fn combine(self, coefficients: MatRef<'_, f64>) -> Mat<f64> {
        let Self { blocks, m_rigid, m_near, m_w, packed, .. } = self;
        drop((m_near, m_w, packed));
        let mut vectors = Mat::zeros(m_rigid.nrows(), coefficients.ncols());
        tall::multiply_blocks(vectors.as_mut(), Accum::Replace, &views(&blocks[1..]), coefficients, 1.0);
        tall::take_out(&mut vectors, blocks[0].as_ref(), m_rigid.as_ref());
        vectors
    }

    /// Makes `w` M-orthogonal to the basis and M-orthonormal, and appends it.
    /// Directions smaller than [`DEPENDENT`] times the block are dropped.
    ///
    /// In exact arithmetic a block that comes of the last one has parts along the last two only; `near` tells how many of
    /// the last blocks that are. These are taken out first, and the rigid modes, which rounding brings in most. What is left
    /// is rounding, and one round takes it out as a rule.
    fn extend(&mut self, mut w: Mat<f64>, near: usize) -> Result<Extension, ModalError> {
        let size = self.size();
        check_memory(w.nrows(), w.ncols())?;
        let mut coefficients = Mat::zeros(FIXED + size, w.ncols());
        let mut coupling = Mat::identity(w.ncols(), w.ncols());
        let of_rigid = tall::take_out(&mut w, self.blocks[0].as_ref(), self.m_rigid.as_ref());
        coefficients.as_mut().subrows_mut(0, FIXED).copy_from(&of_rigid);
        let (_, last) = self.blocks.split_at(self.blocks.len() - near);
        let m_last = self.m_near.iter().skip(self.m_near.len() - near).map(Mat::as_ref).collect::<Vec<_>>();
        let of_near = tall::inner_of_blocks(&m_last, w.as_ref());
        tall::multiply_blocks(w.as_mut(), Accum::Add, &views(last), of_near.as_ref(), -1.0);
        coefficients.as_mut().subrows_mut(FIXED + size - of_near.nrows(), of_near.nrows()).copy_from(&of_near);

        let mut is_orthonormal = false;
        for round in 0..MAX_ROUNDS {
            self.multiply_by_mass(&w);
            let blocks = views(&self.blocks);
            let h = tall::inner_of_blocks(&blocks, self.m_w.as_ref());
            let mut gram = tall::inner(w.as_ref(), self.m_w.as_ref());
            tall::multiply_blocks(w.as_mut(), Accum::Add, &blocks, h.as_ref(), -1.0);
            if round == 0 && near > 0 {
                self.rounding = self.rounding.max(h.norm_max());
            }
            if is_settled(&h, &norms(&gram)) {
                gram -= h.transpose() * &h;
            } else {
                // The difference would be one of nearly equal numbers.
                self.multiply_by_mass(&w);
                gram = tall::inner(w.as_ref(), self.m_w.as_ref());
            }
            let svqb = if round == 0 { Svqb::first(&gram, &h, &(&coefficients + &h))? } else { Svqb::again(&gram)? };
            coefficients += h * &coupling;
            coupling = svqb.inverse * coupling;
            // M·W is not needed any more: room for the product.
            times(&mut w, &svqb.transform, &mut self.m_w);
            is_orthonormal = svqb.well_conditioned;
            if is_orthonormal {
                break;
            }
        }
        self.multiply_by_mass(&w);
        let coefficients = coefficients.subrows(FIXED, size).to_owned();
        let extension = Extension { coefficients, coupling, columns: w.ncols(), is_orthonormal };
        self.blocks.push(w);
        let no_longer_near = if self.m_near.len() < NEAR { None } else { self.m_near.pop_front() };
        let scratch = no_longer_near.unwrap_or_else(Mat::new);
        self.m_near.push_back(std::mem::replace(&mut self.m_w, scratch));
        Ok(extension)
    }

    /// The scratch ← M·W.
    fn multiply_by_mass(&mut self, w: &Mat<f64>) {
        self.m_w.resize_with(w.nrows(), w.ncols(), |_, _| 0.0);
        self.mass.product_into(w.as_ref(), self.m_w.as_mut(), &mut self.packed);
    }
}

/// True if a round took out of columns of these lengths no more than rounding.
fn is_settled(taken_out: &Mat<f64>, norms: &[f64]) -> bool {
    norms.iter().enumerate().all(|(j, norm)| taken_out.col(j).norm_l2() <= SETTLED * norm)
}

fn check_memory(rows: usize, vectors: usize) -> Result<(), ModalError> {
    Ok(memory::check("the Lanczos basis", of_vectors(rows, vectors))?)
}

fn columns(blocks: &[Mat<f64>]) -> usize {
    blocks.iter().map(Mat::ncols).sum()
}

fn views(blocks: &[Mat<f64>]) -> Vec<MatRef<'_, f64>> {
    blocks.iter().map(Mat::as_ref).collect()
}

/// Replaces `block` by `block·transform`.
fn times(block: &mut Mat<f64>, transform: &Mat<f64>, spare: &mut Mat<f64>) {
    spare.resize_with(block.nrows(), transform.ncols(), |_, _| 0.0);
    tall::multiply(spare.as_mut(), Accum::Replace, block.as_ref(), transform.as_ref(), 1.0);
    std::mem::swap(block, spare);
}

impl Svqb {
    /// For a block out of which the `coefficients` were taken, the `last` of them in this round. Nothing counts that is
    /// rounding of what was taken out.
    ///
    /// The Gram matrix does not see directions below 1e-8 of the block. They are not dropped, which would lose
    /// eigenvectors, but stretched as far as is safe: the next round sees them.
    fn first(gram: &Mat<f64>, last: &Mat<f64>, coefficients: &Mat<f64>) -> Result<Self, ModalError> {
        let norms = norms(gram);
        let before = (0..norms.len()).map(|j| norms[j].hypot(coefficients.col(j).norm_l2())).fold(0.0, f64::max);
        let mut first = Self::new(gram, &norms, INDEPENDENT, |_, length| length > DEPENDENT * before)?;
        first.well_conditioned &= is_settled(last, &norms);
        Ok(first)
    }

    /// For a block that [`first`](Self::first) has scaled: what is still small is rounding.
    fn again(gram: &Mat<f64>) -> Result<Self, ModalError> {
        Self::new(gram, &vec![1.0; gram.nrows()], 0.5, |value, _| value > DEPENDENT)
    }
}

/// Numbers in (−1, 1) from a 64-bit linear congruential generator: the same on every run and machine.
pub(crate) fn random_block(rows: usize, columns: usize, seed: &mut u64) -> Mat<f64> {
    Mat::from_fn(rows, columns, |_, _| {
        *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    })
}
