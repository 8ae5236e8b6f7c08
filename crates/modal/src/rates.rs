//! Rates of natural modes with a number that K and M follow: Eqs. (D5)–(D8) of `docs/method/gradients.md`.
//!
//! ```text
//! λ' = φᵀ(K' − λM')φ        (K − λM) φ' = −(K' − λM')φ + λ'Mφ        φᵀMφ' = −½ φᵀM'φ
//! ```
//!
//! φ' along the modes that are known and along the rigid ones follows from products of shapes. On what is left K − λM is definite, since the
//! higher modes alone are in it: conjugate gradients find it, with static responses as the preconditioner. Modes of one frequency are
//! turned into those that the number parts, so that their rates exist.

use std::ops::Range;

use faer::{Accum, Mat, MatRef, Side};

use crate::error::ModalError;
use crate::matrix::tall;
use crate::solve::{Modes, Solver};
use crate::statics::response::StaticAccuracy;

/// Eigenvalues that are apart by less than this part are one.
const REPEATED: f64 = 1e-8;
/// Norm of the residual, relative to that of the forces, at which a rate of a shape is found.
const TOLERANCE: f64 = 1e-10;
/// Most iterations.
const MAX_ITERATIONS: usize = 200;

/// Rates of natural modes with one number.
#[derive(Debug, Clone)]
pub struct ModeRates {
    /// λ', of modes of one frequency in rising order.
    pub eigenvalues: Vec<f64>,
    /// Turns of the shapes (n×n, orthogonal): φ = Φ × column, which parts modes of one frequency; else the unit matrix.
    pub turn: Mat<f64>,
}

impl Modes {
    /// Groups of the first natural modes that have one frequency; a mode apart is none.
    pub fn repeated(&self, count: usize) -> Vec<Range<usize>> {
        let lambda = &self.eigenvalues[..count.min(self.natural())];
        repeated(lambda, |before, after| after - before <= REPEATED * after)
    }

    /// The number of first natural modes, `count` or a few more, that cuts no group of one frequency.
    pub fn whole(&self, count: usize) -> usize {
        let cut = self.repeated(self.natural()).into_iter().find(|group| group.start < count && count < group.end);
        cut.map_or(count, |group| group.end)
    }

    /// Rates of the first natural modes by K'Φ and M'Φ (N×n each); n is [`whole`](Self::whole).
    ///
    /// # Errors
    /// [`ModalError::Size`], [`ModalError::DenseEigen`].
    pub fn rates(&self, [of_stiffness, of_mass]: [MatRef<'_, f64>; 2]) -> Result<ModeRates, ModalError> {
        let count = of_stiffness.ncols().min(self.natural());
        let shapes = self.shapes.get(.., ..count);
        let own = |k: usize| {
            let phi = shapes.col(k).transpose();
            phi * of_stiffness.col(k) - self.eigenvalues[k] * (phi * of_mass.col(k))
        };
        let mut eigenvalues: Vec<f64> = (0..count).map(own).collect();
        let mut turn = Mat::identity(count, count);
        for group in self.repeated(count) {
            let lambda = self.mean_eigenvalue(&group);
            let size = group.len();
            let phi = shapes.subcols(group.start, size);
            let force =
                of_stiffness.subcols(group.start, size) - of_mass.subcols(group.start, size) * faer::Scale(lambda);
            let block = phi.transpose() * force;
            let block = Mat::from_fn(size, size, |i, j| 0.5 * (block[(i, j)] + block[(j, i)]));
            let found = block.self_adjoint_eigen(Side::Lower).map_err(|_| ModalError::DenseEigen { size })?;
            for (k, rate) in found.S().column_vector().iter().enumerate() {
                eigenvalues[group.start + k] = *rate;
            }
            turn.as_mut().submatrix_mut(group.start, group.start, size, size).copy_from(found.U());
        }
        Ok(ModeRates { eigenvalues, turn })
    }

    fn mean_eigenvalue(&self, group: &Range<usize>) -> f64 {
        self.eigenvalues[group.clone()].iter().sum::<f64>() / group.len() as f64
    }
}

impl Solver<'_> {
    /// Rates φ' (N×n) of the first shapes, turned as `rates` turns them, by K'Φ and M'Φ (N×n each) of all `modes`, which should be
    /// more than are asked for: the nearer the next frequency, the more iterations. Of modes of one frequency, only sums that do not
    /// change where they are turned into each other have the rates that follow from these, as effective masses.
    ///
    /// # Errors
    /// [`ModalError::StaticNotConverged`], and as [`static_response`](Self::static_response).
    pub fn shape_rates(
        &self,
        modes: &Modes,
        rates: &ModeRates,
        [of_stiffness, of_mass]: [MatRef<'_, f64>; 2],
    ) -> Result<Mat<f64>, ModalError> {
        let count = rates.eigenvalues.len();
        let natural = modes.natural();
        let known = modes.shapes.get(.., ..natural);
        let (rigid, lambda) = (self.rigid.shapes.as_ref(), &modes.eigenvalues);
        // All known shapes, with the first ones turned.
        let mut shapes = known.to_owned();
        shapes.as_mut().subcols_mut(0, count).copy_from(tall::product(known.subcols(0, count), rates.turn.as_ref()));
        let turned = |of: MatRef<'_, f64>| tall::product(of.subcols(0, count), rates.turn.as_ref());
        let (k_rate, m_rate) = (turned(of_stiffness), turned(of_mass));
        let mut m_shapes = self.mass.product(shapes.as_ref());
        self.constraints.project(m_shapes.as_mut());
        let group_of: Vec<Range<usize>> = {
            let groups = modes.repeated(count);
            let of = |k: usize| groups.iter().find(|group| group.contains(&k)).cloned().unwrap_or(k..k + 1);
            (0..count).map(of).collect()
        };
        let mut forces = Mat::zeros(known.nrows(), count);
        for (k, group) in group_of.iter().enumerate() {
            let lambda = modes.mean_eigenvalue(group);
            let force = m_rate.col(k) * faer::Scale(lambda) - k_rate.col(k);
            forces.col_mut(k).copy_from(force);
        }
        self.constraints.project(forces.as_mut());
        let of_known = tall::inner(shapes.as_ref(), forces.as_ref());
        let of_rigid = tall::inner(rigid, forces.as_ref());
        let m_own = tall::inner(shapes.as_ref(), m_rate.as_ref());
        let parts = Mat::from_fn(natural, count, |j, k| {
            if group_of[k].contains(&j) {
                -0.5 * m_own[(j, k)]
            } else {
                of_known[(j, k)] / (lambda[j] - modes.mean_eigenvalue(&group_of[k]))
            }
        });
        let rigid_parts =
            Mat::from_fn(rigid.ncols(), count, |j, k| -of_rigid[(j, k)] / modes.mean_eigenvalue(&group_of[k]));
        let mut answer = tall::product(shapes.as_ref(), parts.as_ref());
        tall::multiply(answer.as_mut(), Accum::Add, rigid, rigid_parts.as_ref(), 1.0);
        // The energy of the forces along known shapes, before they cancel: where all shapes are known, what is left is rounding.
        let k_own = tall::inner(shapes.as_ref(), k_rate.as_ref());
        let own: Vec<f64> = group_of.iter().map(|group| modes.mean_eigenvalue(group)).collect();
        let energy = |k: usize| -> f64 {
            let squared = |j: usize| k_own[(j, k)].powi(2) + (own[k] * m_own[(j, k)]).powi(2);
            (0..natural).map(|j| squared(j) / lambda[j]).sum()
        };
        let energies: Vec<f64> = (0..count).map(energy).collect();
        answer += Beyond { solver: self, modes, shapes, m_shapes }.solve(&own, &energies, forces)?;
        Ok(answer)
    }
}

/// Groups of more than one member of a list whose neighbours are the same.
pub fn repeated<T>(list: &[T], is_same: impl FnMut(&T, &T) -> bool) -> Vec<Range<usize>> {
    let mut end = 0;
    let groups = list.chunk_by(is_same).map(|group| {
        let start = end;
        end += group.len();
        start..end
    });
    groups.filter(|group| group.len() > 1).collect()
}

/// The displacements that are M-orthogonal to all shapes that are known and to the rigid ones.
struct Beyond<'a> {
    solver: &'a Solver<'a>,
    modes: &'a Modes,
    shapes: Mat<f64>,
    m_shapes: Mat<f64>,
}

impl Beyond<'_> {
    /// (K − λM)⁻¹ of what is left of forces (N×n), each with its λ and with the energy of what it had along known shapes.
    fn solve(&self, lambda: &[f64], energies: &[f64], mut residual: Mat<f64>) -> Result<Mat<f64>, ModalError> {
        self.balance(&mut residual);
        let (rows, columns) = (residual.nrows(), residual.ncols());
        let [mut answer, mut search] = [(); 2].map(|()| Mat::<f64>::zeros(rows, columns));
        let mut conditioned = self.conditioned(&residual)?;
        let mut squared = dots(&residual, &conditioned);
        let whole: Vec<f64> = squared.iter().zip(energies).map(|(squared, energy)| squared + energy).collect();
        let mut before = vec![f64::INFINITY; columns];
        for iteration in 0.. {
            let left = |k: usize| if whole[k] > 0.0 { (squared[k] / whole[k]).max(0.0).sqrt() } else { 0.0 };
            let open: Vec<usize> = (0..columns).filter(|k| left(*k) > TOLERANCE).collect();
            let Some(column) = open.first().copied() else { break };
            if iteration == MAX_ITERATIONS || open.iter().any(|k| !squared[*k].is_finite()) {
                let (residual, tolerance) = (left(column), TOLERANCE);
                return Err(ModalError::StaticNotConverged { column, iterations: iteration, residual, tolerance });
            }
            for k in &open {
                let part = squared[*k] / before[*k];
                let next = conditioned.col(*k) + search.col(*k) * faer::Scale(part);
                search.col_mut(*k).copy_from(next);
            }
            let mut stiff = self.solver.stiffness.product(search.as_ref());
            let inertia = self.solver.mass.product(search.as_ref());
            for (k, lambda) in lambda.iter().enumerate() {
                let force = stiff.col(k) - inertia.col(k) * faer::Scale(*lambda);
                stiff.col_mut(k).copy_from(force);
            }
            self.solver.constraints.project(stiff.as_mut());
            let curvature = dots(&search, &stiff);
            for k in &open {
                let step = squared[*k] / curvature[*k];
                let next = answer.col(*k) + search.col(*k) * faer::Scale(step);
                answer.col_mut(*k).copy_from(next);
                let next = residual.col(*k) - stiff.col(*k) * faer::Scale(step);
                residual.col_mut(*k).copy_from(next);
                before[*k] = squared[*k];
            }
            self.balance(&mut residual);
            conditioned = self.conditioned(&residual)?;
            squared = dots(&residual, &conditioned);
        }
        Ok(answer)
    }

    /// Takes out of forces what the known shapes, the rigid ones and the reactions balance.
    fn balance(&self, forces: &mut Mat<f64>) {
        self.solver.constraints.project(forces.as_mut());
        tall::take_out(forces, self.m_shapes.as_ref(), self.shapes.as_ref());
    }

    /// Static responses without their parts along the known shapes.
    fn conditioned(&self, forces: &Mat<f64>) -> Result<Mat<f64>, ModalError> {
        let mut answer = self.solver.static_response_from(self.modes, forces.as_ref(), StaticAccuracy::Full)?;
        tall::take_out(&mut answer, self.shapes.as_ref(), self.m_shapes.as_ref());
        Ok(answer)
    }
}

/// Products of the columns with each other.
fn dots(a: &Mat<f64>, b: &Mat<f64>) -> Vec<f64> {
    a.col_iter().zip(b.col_iter()).map(|(a, b)| a.transpose() * b).collect()
}
