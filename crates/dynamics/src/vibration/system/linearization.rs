//! The reduction of the linearised equations to independent coordinates.

use faer::linalg::solvers::Solve;
use faer::{Mat, Side};

use crate::system::description::System;
use crate::vibration::system::error::SteadyError;
use crate::vibration::system::terms::{Spring, Terms};
use crate::vibration::system::tie::{Tie, stiffnesses};

/// A strain of springs below this part of the largest is rounding.
const UNSTRAINED: f64 = 1e-13;

/// The linearised equations over independent coordinates η: η̈ + C η̇ + K η = 0, changes of place ξ = N η.
///
/// The first coordinates are those that deform no body, of these first those that strain no spring.
#[derive(Debug, Clone)]
pub struct Linearization {
    /// N (n×nη), n the coordinates of all bodies: ρ and φ in body axes, and δq, of each.
    pub basis: Mat<f64>,
    /// K (nη×nη).
    pub stiffness: Mat<f64>,
    /// C (nη×nη).
    pub damping: Mat<f64>,
    /// Number of coordinates that deform no body.
    pub rigid: usize,
    /// Number of coordinates that deform no body and strain no spring.
    pub(crate) unsprung: usize,
    /// Λ of the slowest vibration of the bodies, or the terms of springs before they cancel in the coordinates that strain none; zero without any. Where
    /// no force acts, all terms of a motion as a whole are rounding, and are judged by this.
    pub(crate) strain_floor: f64,
    /// The magnitude of the terms of K and C, but for those of springs, in the coordinates that deform nothing, to which their rounding is in proportion.
    pub(crate) magnitudes: [f64; 2],
    /// First coordinate of each body, and their number.
    pub(crate) first: Vec<usize>,
    /// Λ of all coordinates; zero of the rigid ones.
    pub(crate) strain: Vec<f64>,
    pub(crate) masses: Vec<Mat<f64>>,
    pub(crate) springs: Vec<(Spring, Tie)>,
}

impl Linearization {
    pub(crate) fn new(system: &System, terms: &Terms, springs: Vec<(Spring, Tie)>) -> Result<Self, SteadyError> {
        let n = system.coordinates();
        let basis = null_space(system, terms)?;
        let strain: Vec<f64> =
            system.bodies.iter().flat_map(|body| std::iter::repeat_n(0.0, 6).chain(stiffnesses(body))).collect();
        let size = basis.ncols();
        let strained: Vec<usize> = (0..n).filter(|k| strain[*k] > 0.0).collect();
        let roots = Mat::from_fn(strained.len(), size, |i, j| strain[strained[i]].sqrt() * basis[(strained[i], j)]);
        // Right singular vectors by falling strain; those of motions that deform nothing are the last.
        let svd = roots.svd().map_err(|_| SteadyError::Numbers)?;
        let rigid = terms.rigid_motions.min(size).max(size.saturating_sub(strained.len()));
        let order: Vec<usize> = (0..size).rev().collect();
        let turned = Mat::from_fn(size, size, |i, j| svd.V()[(i, order[j])]);
        let mut basis: Mat<f64> = basis * turned;
        let values = svd.S().column_vector();
        let strain_rates: Vec<f64> = order
            .iter()
            .enumerate()
            .map(|(k, of)| if k < rigid || *of >= values.nrows() { 0.0 } else { values[*of] })
            .collect();
        for (k, j) in (0..rigid).flat_map(|j| strained.iter().map(move |k| (*k, j))) {
            basis[(k, j)] = 0.0;
        }
        let (basis, strains, unsprung) = unstrained_first(basis, rigid, &terms.springs)?;
        let reduce = |matrix: &Mat<f64>| basis.transpose() * (matrix * &basis);
        // |N|ᵀ |K| |N| of the coordinates that deform nothing.
        let absolute = |matrix: &Mat<f64>| Mat::from_fn(matrix.nrows(), matrix.ncols(), |i, j| matrix[(i, j)].abs());
        let columns = absolute(&basis.get(.., ..unsprung).to_owned());
        let magnitude = |matrix: &Mat<f64>| (columns.transpose() * (absolute(matrix) * &columns)).norm_max();
        let [of_forces, accelerated] = [&terms.unsprung, &terms.accelerated].map(magnitude);
        let magnitudes = [of_forces.max(accelerated), magnitude(&terms.damping)];
        let of_springs = absolute(&terms.springs) * &columns;
        let of_springs = (0..unsprung).map(|k| of_springs.col(k).squared_norm_l2()).fold(0.0, f64::max);
        let of_bodies = strain.iter().copied().filter(|strain| *strain > 0.0).reduce(f64::min);
        let strain_floor = of_springs.max(of_bodies.unwrap_or(0.0));
        let mut stiffness = reduce(&terms.unsprung) + strains.transpose() * &strains;
        let damping = reduce(&terms.damping);
        strain_rates.iter().enumerate().for_each(|(k, rate)| stiffness[(k, k)] += rate * rate);
        Ok(Self {
            basis,
            stiffness,
            damping,
            rigid,
            unsprung,
            magnitudes,
            strain_floor,
            first: system.first.clone(),
            strain,
            masses: terms.masses.clone(),
            springs,
        })
    }

    /// Holders of elastic energy beside the bodies, in the order of [`SystemMode::elastic`](crate::SystemMode).
    pub fn springs(&self) -> impl Iterator<Item = Spring> {
        self.springs.iter().map(|(spring, _)| *spring)
    }

    /// The coordinates of a body among those of all.
    pub fn coordinates_of(&self, body: usize) -> std::ops::Range<usize> {
        self.first[body]..self.first[body + 1]
    }

    /// Number of independent coordinates.
    pub fn size(&self) -> usize {
        self.basis.ncols()
    }

    /// Nᵀ x
    pub(crate) fn project(&self, x: &[f64]) -> Vec<f64> {
        (0..self.size()).map(|j| x.iter().enumerate().map(|(i, x)| self.basis[(i, j)] * x).sum()).collect()
    }

    /// N x
    pub(crate) fn expand(&self, x: &[f64]) -> Vec<f64> {
        (0..self.basis.nrows()).map(|i| x.iter().enumerate().map(|(j, x)| self.basis[(i, j)] * x).sum()).collect()
    }

    /// The changes of the coordinates that deform bodies by these forces on all coordinates (nη).
    pub(crate) fn deflection(&self, forces: &[f64]) -> Vec<f64> {
        let (first, count) = (self.rigid, self.size() - self.rigid);
        let mut change = vec![0.0; self.size()];
        if count > 0 {
            let right = Mat::from_fn(count, 1, |i, _| forces[first + i]);
            let solved = self.stiffness.get(first.., first..).to_owned().partial_piv_lu().solve(&right);
            (0..count).for_each(|i| change[first + i] = solved[(i, 0)]);
        }
        change
    }
}

/// Turns the motions that deform no body so that those that strain no spring come first, and gives the rows B N of the springs, in which these have
/// nothing, where a product would leave them the rounding of the stiffest, and their number.
fn unstrained_first(
    mut basis: Mat<f64>,
    rigid: usize,
    springs: &Mat<f64>,
) -> Result<(Mat<f64>, Mat<f64>, usize), SteadyError> {
    let mut strains = springs * &basis;
    if rigid == 0 || springs.nrows() == 0 {
        return Ok((basis, strains, rigid));
    }
    let svd = strains.get(.., ..rigid).to_owned().svd().map_err(|_| SteadyError::Numbers)?;
    let values = svd.S().column_vector();
    let value = |k: usize| if k < values.nrows() { values[k] } else { 0.0 };
    let turn = Mat::from_fn(rigid, rigid, |i, j| svd.V()[(i, rigid - 1 - j)]);
    for part in [&mut basis, &mut strains] {
        let turned = part.get(.., ..rigid) * &turn;
        part.get_mut(.., ..rigid).copy_from(&turned);
    }
    let unsprung = (0..rigid).filter(|k| value(*k) <= UNSTRAINED * value(0)).count();
    (0..unsprung).for_each(|j| strains.col_mut(j).fill(0.0));
    Ok((basis, strains, unsprung))
}

/// An M-orthonormal basis of the motions that the rows leave.
fn null_space(system: &System, terms: &Terms) -> Result<Mat<f64>, SteadyError> {
    let n = system.coordinates();
    let kept: Vec<usize> = (0..terms.rows.nrows()).filter(|row| !terms.is_implied[*row]).collect();
    // Turns of point masses, which have none, are held.
    let points = system.bodies.iter().zip(&system.first).filter(|(body, _)| body.is_point());
    let held: Vec<usize> = points.flat_map(|(_, first)| first + 3..first + 6).collect();
    let rows = kept.len() + held.len();
    // M = Lᵐ Lᵐᵀ of each body; of z = Lᵐᵀ ξ all that is orthogonal to the columns of Lᵐ⁻¹ Gᵀ.
    let masses = terms.masses.iter().zip(&system.bodies).map(|(mass, body)| {
        let turns = if body.is_point() { body.mass() } else { 0.0 };
        Mat::from_fn(mass.nrows(), mass.ncols(), |i, j| mass[(i, j)] + if i == j && i >= 3 { turns } else { 0.0 })
    });
    let factors = masses.map(|mass| mass.llt(Side::Lower).map(|llt| llt.L().to_owned()));
    let factors: Vec<Mat<f64>> = factors.collect::<Result<_, _>>().map_err(|_| SteadyError::Numbers)?;
    let mut columns = Mat::from_fn(n, rows, |k, j| match kept.get(j) {
        Some(row) => terms.rows[(*row, k)],
        None => f64::from(u8::from(held[j - kept.len()] == k)),
    });
    for (factor, first) in factors.iter().zip(&system.first) {
        let block = columns.submatrix_mut(*first, 0, factor.nrows(), rows);
        faer::linalg::triangular_solve::solve_lower_triangular_in_place(factor.as_ref(), block, faer::Par::Seq);
    }
    for j in 0..rows {
        let norm = columns.col(j).norm_l2();
        if norm > 0.0 {
            columns.col_mut(j).iter_mut().for_each(|x| *x /= norm);
        }
    }
    let left = n - rows;
    let mut basis = if rows == 0 { Mat::identity(n, n) } else { columns.qr().compute_Q().get(.., rows..).to_owned() };
    for (factor, first) in factors.iter().zip(&system.first) {
        let block = basis.submatrix_mut(*first, 0, factor.nrows(), left);
        faer::linalg::triangular_solve::solve_upper_triangular_in_place(factor.transpose(), block, faer::Par::Seq);
    }
    Ok(basis)
}
