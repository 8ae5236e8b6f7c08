//! A Newton step with forces that follow the displacements.
//!
//! ```text
//! K* e − L e = r        L = ∂f/∂u
//! ```
//!
//! L of a pressure on a part of the surface, of a moment or of a force that turns is no symmetric matrix: it is not in K*, and
//! the step comes from `e − K*⁻¹ L e = K*⁻¹ r` by GMRES. A direction costs one solution by the factor that is there.

use nalgebra::{DMatrix, DVector};

use crate::body::FullBody;
use crate::error::NonlinearError;
use crate::forces::ExternalForces;
use crate::tangent::Tangent;
use crate::vectors::{add, dot, peak, sum};

/// Directions at most.
const DIRECTIONS: usize = 12;
/// Rest that is accepted, relative, in the norm of M.
const ACCEPTED: f64 = 1e-6;
/// Displacement over the size of the body for the difference that L is found by.
const DIFFERENCE: f64 = 1e-5;

/// The displacements e of a step at u, where `residual` are the forces that are left.
pub(crate) fn change(
    body: &FullBody<'_>,
    tangent: &Tangent<'_>,
    forces: &ExternalForces,
    u: &[f64],
    residual: &[f64],
) -> Result<Vec<f64>, NonlinearError> {
    let first = tangent.answer(residual)?;
    let norm = |e: &[f64]| dot(e, &body.momentum(e)).max(0.0).sqrt();
    let scale = norm(&first);
    if !forces.follow() || scale == 0.0 {
        return Ok(first);
    }
    let mut basis: Vec<Vec<f64>> = vec![first.iter().map(|e| e / scale).collect()];
    let mut columns: Vec<Vec<f64>> = Vec::new();
    let (mut best, mut least) = (first, f64::INFINITY);
    for k in 0..DIRECTIONS {
        let mut next = sum(&basis[k], -1.0, &tangent.answer(&load_change(body, forces, u, &basis[k])?)?);
        let mut column = Vec::with_capacity(k + 2);
        for direction in &basis {
            let part = dot(direction, &body.momentum(&next));
            add(&mut next, -part, direction);
            column.push(part);
        }
        let rest = norm(&next);
        column.push(rest);
        columns.push(column);
        let matrix = DMatrix::from_fn(k + 2, k + 1, |i, j| columns[j].get(i).copied().unwrap_or(0.0));
        let right = DVector::from_fn(k + 2, |i, _| if i == 0 { scale } else { 0.0 });
        let svd = matrix.clone().svd(true, true);
        let weights = svd.solve(&right, 1e-14).map_err(|_| NonlinearError::Singular)?;
        let left = (right - matrix * &weights).norm() / scale;
        if left < least {
            least = left;
            best.fill(0.0);
            basis.iter().zip(weights.iter()).for_each(|(direction, weight)| add(&mut best, *weight, direction));
        }
        if least < ACCEPTED || rest < ACCEPTED * ACCEPTED {
            break;
        }
        next.iter_mut().for_each(|e| *e /= rest);
        basis.push(next);
    }
    Ok(best)
}

/// L e at u, by a difference.
pub(crate) fn load_change(
    body: &FullBody<'_>,
    forces: &ExternalForces,
    u: &[f64],
    e: &[f64],
) -> Result<Vec<f64>, NonlinearError> {
    let size = body.mesh().positions().iter().flatten().fold(0.0, |size: f64, x| size.max(x.abs()));
    let length = peak(e);
    if length == 0.0 {
        return Ok(vec![0.0; e.len()]);
    }
    let h = DIFFERENCE * size / length;
    let at = |step: f64| forces.at(body.mesh(), &sum(u, step, e));
    Ok(sum(&at(h)?, -1.0, &at(-h)?).iter().map(|f| f / (2.0 * h)).collect())
}
