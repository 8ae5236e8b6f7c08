//! The reduction of the linearised equations to independent coordinates.

use faer::Mat;
use faer::linalg::solvers::Solve;

use crate::system::description::System;
use crate::vibration::system::blocks::Blocks;
use crate::vibration::system::error::SteadyError;
use crate::vibration::system::null_space::null_space;
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
        let rigid = terms.rigid_motions.min(size).max(size.saturating_sub(strained.len()));
        let (basis, strain_rates) = match strained.is_empty() {
            true => (basis, vec![0.0; size]),
            false => rigid_first(basis, rigid, &strained, &strain)?,
        };
        let (basis, strains, unsprung) = unstrained_first(basis, rigid, &terms.springs)?;
        // |N|ᵀ |K| |N| of the coordinates that deform nothing.
        let absolute = |matrix: &Mat<f64>| Mat::from_fn(matrix.nrows(), matrix.ncols(), |i, j| matrix[(i, j)].abs());
        let columns = absolute(&basis.get(.., ..unsprung).to_owned());
        let magnitude = |matrix: &Blocks| matrix.absolute().reduced(&columns).norm_max();
        let [of_forces, accelerated] = [&terms.unsprung, &terms.accelerated].map(magnitude);
        let magnitudes = [of_forces.max(accelerated), magnitude(&terms.damping)];
        let of_springs = absolute(&terms.springs) * &columns;
        let of_springs = (0..unsprung).map(|k| of_springs.col(k).squared_norm_l2()).fold(0.0, f64::max);
        let of_bodies = strain.iter().copied().filter(|strain| *strain > 0.0).reduce(f64::min);
        let strain_floor = of_springs.max(of_bodies.unwrap_or(0.0));
        let mut stiffness = terms.unsprung.reduced(&basis);
        if strains.nrows() > 0 {
            stiffness += strains.transpose() * &strains;
        }
        let damping = terms.damping.reduced(&basis);
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

    /// Modes of unit mass of a body whose frame is given: K beside Λ, and C.
    pub(crate) fn of_modes(circular_frequencies: &[f64], mut stiffness: Mat<f64>, damping: Mat<f64>) -> Self {
        let size = circular_frequencies.len();
        let strain: Vec<f64> = circular_frequencies.iter().map(|omega| omega * omega).collect();
        strain.iter().enumerate().for_each(|(k, strain)| stiffness[(k, k)] += strain);
        Self {
            basis: Mat::identity(size, size),
            stiffness,
            damping,
            rigid: 0,
            unsprung: 0,
            strain_floor: 0.0,
            magnitudes: [0.0; 2],
            first: vec![0, size],
            strain,
            masses: vec![Mat::identity(size, size)],
            springs: Vec::new(),
        }
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

/// Turns the motions so that those that deform no body come first, without the rounding of what does, and gives the root of the strain of each (Λ).
fn rigid_first(
    basis: Mat<f64>,
    rigid: usize,
    strained: &[usize],
    strain: &[f64],
) -> Result<(Mat<f64>, Vec<f64>), SteadyError> {
    let size = basis.ncols();
    let roots = Mat::from_fn(strained.len(), size, |i, j| strain[strained[i]].sqrt() * basis[(strained[i], j)]);
    // Right singular vectors by falling strain; those of motions that deform nothing are the last.
    let svd = roots.svd().map_err(|_| SteadyError::Numbers)?;
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
    Ok((basis, strain_rates))
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
