//! Static responses of a solid.

use nalgebra::{DMatrix, DVector};

use crate::nonlinear::error::SolidError;
use crate::nonlinear::motion::{clear, dot, norm};
use crate::nonlinear::solid::Solid;

/// Most iterations: with a large shift they come to rest slowly.
const MOST: usize = 300;
/// Iterations of a subspace that begins near the answer.
const SUBSPACE: usize = 20;
/// Rest of the forces or of the displacements that is accepted, relative.
const TOLERANCE: f64 = 1e-11;

impl Solid {
    /// The displacements at rest under forces that depend on them, from zero in `steps` steps of the forces. `shift`, zero
    /// for a body that is held, is a small square of a circular frequency: forces on a free body have no resultant.
    ///
    /// # Errors
    /// [`SolidError`] where no equilibrium is found.
    pub fn at_rest(
        &self,
        steps: usize,
        shift: f64,
        forces: impl Fn(&[f64]) -> Vec<f64>,
    ) -> Result<Vec<f64>, SolidError> {
        let mut u = vec![0.0; self.dofs()];
        for step in 1..=steps {
            let part = step as f64 / steps as f64;
            let mut last = f64::INFINITY;
            for iteration in 0.. {
                let internal = self.internal_forces(&u, &u);
                let mut applied = forces(&u);
                applied.iter_mut().for_each(|f| *f *= part);
                clear(self, &mut applied);
                let mut residual: Vec<f64> = applied.iter().zip(&internal).map(|(f, i)| f - i).collect();
                clear(self, &mut residual);
                let left = norm(&residual) / norm(&applied);
                if left < TOLERANCE || (left < 1e-7 && left > 0.5 * last) {
                    break;
                }
                if iteration == MOST || !left.is_finite() {
                    return Err(SolidError::Iterations { at: part, residual: left });
                }
                last = left;
                self.tangent(&u, &u, shift, 1.0)?.solve(&mut residual);
                u.iter_mut().zip(&residual).for_each(|(u, du)| *u += du);
            }
        }
        Ok(u)
    }

    /// The lowest circular frequencies of small vibrations about a rest `u` under dead forces, as many as there are `shapes`
    /// near their modes, by subspace iteration.
    ///
    /// # Errors
    /// [`SolidError::Factor`] where the rest is not stable.
    pub fn frequencies_at_rest(&self, u: &[f64], shapes: &[Vec<f64>]) -> Result<Vec<f64>, SolidError> {
        let factor = self.tangent(u, u, 0.0, 1.0)?;
        let count = shapes.len();
        let mut shapes = shapes.to_vec();
        let mut squares = vec![0.0; count];
        for _ in 0..SUBSPACE {
            let momenta: Vec<Vec<f64>> = shapes
                .iter()
                .map(|shape| {
                    let mut momentum = self.momentum(shape);
                    clear(self, &mut momentum);
                    momentum
                })
                .collect();
            let mut answers = momenta.clone();
            answers.iter_mut().for_each(|answer| factor.solve(answer));
            // Of the answers y: K y = M x.
            let moving: Vec<Vec<f64>> = answers.iter().map(|answer| self.momentum(answer)).collect();
            let stiffness = DMatrix::from_fn(count, count, |i, j| dot(&answers[i], &momenta[j]));
            let mass = DMatrix::from_fn(count, count, |i, j| dot(&answers[i], &moving[j]));
            let lower = mass.cholesky().ok_or(SolidError::Factor)?.l();
            let inverse = lower.try_inverse().ok_or(SolidError::Factor)?;
            let found = (&inverse * stiffness * inverse.transpose()).symmetric_eigen();
            let mixed = inverse.transpose() * &found.eigenvectors;
            shapes = (0..count)
                .map(|k| {
                    let mut shape = vec![0.0; u.len()];
                    for (i, answer) in answers.iter().enumerate() {
                        shape.iter_mut().zip(answer).for_each(|(sum, y)| *sum += mixed[(i, k)] * y);
                    }
                    shape
                })
                .collect();
            squares = found.eigenvalues.iter().copied().collect();
        }
        squares.sort_by(f64::total_cmp);
        Ok(squares.into_iter().map(f64::sqrt).collect())
    }

    /// The displacements of least strain energy with given parts `amounts` along M-orthonormal `shapes`, those of rigid
    /// motion among them for a free body, in `steps` steps from zero. `shift` is a small square of a circular frequency,
    /// against the others.
    ///
    /// # Errors
    /// [`SolidError`] where none are found.
    pub fn held_in_modes(
        &self,
        shapes: &[Vec<f64>],
        amounts: &[f64],
        shift: f64,
        steps: usize,
    ) -> Result<Vec<f64>, SolidError> {
        let momenta: Vec<Vec<f64>> = shapes.iter().map(|shape| self.momentum(shape)).collect();
        let mut u = vec![0.0; self.dofs()];
        for step in 1..=steps {
            let part = step as f64 / steps as f64;
            let amounts: Vec<f64> = amounts.iter().map(|amount| part * amount).collect();
            self.hold(&mut u, &momenta, &amounts, shift)?;
        }
        Ok(u)
    }

    /// Newton's iteration with a bordered tangent.
    fn hold(&self, u: &mut [f64], momenta: &[Vec<f64>], amounts: &[f64], shift: f64) -> Result<(), SolidError> {
        let (count, mut last) = (momenta.len(), f64::INFINITY);
        for _ in 0..MOST {
            let mut change: Vec<f64> = self.internal_forces(u, u).iter().map(|f| -f).collect();
            let factor = self.tangent(u, u, shift, 1.0)?;
            factor.solve(&mut change);
            let mut through = momenta.to_vec();
            through.iter_mut().for_each(|column| factor.solve(column));
            let border = DMatrix::from_fn(count, count, |i, j| dot(&momenta[i], &through[j]));
            let excess = |i: usize| dot(&momenta[i], u) + dot(&momenta[i], &change) - amounts[i];
            let forces = border.lu().solve(&DVector::from_fn(count, |i, _| excess(i))).ok_or(SolidError::Factor)?;
            for (column, force) in through.iter().zip(&forces) {
                change.iter_mut().zip(column).for_each(|(du, c)| *du -= force * c);
            }
            u.iter_mut().zip(&change).for_each(|(u, du)| *u += du);
            let left = norm(&change) / norm(u);
            if left < TOLERANCE || (left < 1e-8 && left > 0.5 * last) {
                return Ok(());
            }
            last = left;
        }
        Err(SolidError::Iterations { at: 1.0, residual: last })
    }
}
