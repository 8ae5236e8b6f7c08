//! The motion of a solid by the energy–momentum midpoint rule.
//!
//! ```text
//! M (v' − v)/h = f(t + h/2, ½(u + u')) − f_int(u, u')        u' − u = h ½(v + v')
//! ```
//!
//! Without loads it keeps energy, momentum and angular momentum for any step (Simo and Tarnow 1992). A small vibration ω
//! comes out as ω' with `tan ½ω'h = ½ωh`.

use crate::nonlinear::error::SolidError;
use crate::nonlinear::solid::{Factor, Solid};

/// Most iterations in a step.
const MOST: usize = 40;
/// Rest of the forces that is accepted, relative to the largest of their kinds.
const TOLERANCE: f64 = 1e-11;
/// The tangent is made anew where an iteration leaves more than this of the last one.
const SLOW: f64 = 0.2;

/// Displacements and velocities of the nodes at a time.
#[derive(Clone)]
pub struct NodalState {
    /// Time.
    pub time: f64,
    /// Displacements (3n).
    pub u: Vec<f64>,
    /// Velocities (3n).
    pub v: Vec<f64>,
}

/// A solid that moves under forces that depend on the time and on the displacements.
pub struct SolidMotion<'a, F> {
    solid: &'a Solid,
    forces: F,
    step: f64,
    factor: Option<Factor>,
    /// Where it is.
    pub state: NodalState,
}

impl<'a, F: Fn(f64, &[f64]) -> Vec<f64>> SolidMotion<'a, F> {
    /// From a state, in equal steps.
    pub fn new(solid: &'a Solid, state: NodalState, step: f64, forces: F) -> Self {
        Self { solid, forces, step, factor: None, state }
    }

    /// One step.
    ///
    /// # Errors
    /// [`SolidError`] where the iteration does not come to rest.
    pub fn advance(&mut self) -> Result<(), SolidError> {
        let (solid, h) = (self.solid, self.step);
        let NodalState { time, u, v } = &self.state;
        let mut next: Vec<f64> = u.iter().zip(v).map(|(u, v)| u + h * v).collect();
        let mut last = f64::INFINITY;
        for _ in 0..MOST {
            let half: Vec<f64> = u.iter().zip(&next).map(|(a, b)| 0.5 * (a + b)).collect();
            let change: Vec<f64> = (0..u.len()).map(|i| 2.0 / (h * h) * (next[i] - u[i] - h * v[i])).collect();
            let inertia = solid.momentum(&change);
            let internal = solid.internal_forces(u, &next);
            let applied = (self.forces)(time + 0.5 * h, &half);
            let mut residual: Vec<f64> = (0..u.len()).map(|i| applied[i] - internal[i] - inertia[i]).collect();
            clear(solid, &mut residual);
            let scale = norm(&applied) + norm(&internal) + norm(&inertia);
            let left = norm(&residual);
            if left <= TOLERANCE * scale {
                break;
            }
            // Rounding of the internal forces, which are differences of larger ones, ends it too.
            if left > 0.5 * last && left < 1e-7 * scale {
                break;
            }
            if last.is_infinite() && !residual.iter().all(|r| r.is_finite()) {
                return Err(SolidError::Iterations { at: *time, residual: left });
            }
            let factor = match self.factor.take().filter(|_| left < SLOW * last) {
                Some(factor) => factor,
                None => solid.tangent(u, &next, 2.0 / (h * h), 0.5)?,
            };
            factor.solve(&mut residual);
            self.factor = Some(factor);
            next.iter_mut().zip(&residual).for_each(|(next, du)| *next += du);
            last = left;
        }
        if !next.iter().all(|u| u.is_finite()) {
            return Err(SolidError::Iterations { at: *time, residual: last });
        }
        let v = (0..u.len()).map(|i| 2.0 / h * (next[i] - u[i]) - v[i]).collect();
        self.state = NodalState { time: time + h, u: next, v };
        Ok(())
    }

    /// Kinetic energy and strain energy.
    pub fn energies(&self) -> [f64; 2] {
        let kinetic = 0.5 * dot(&self.state.v, &self.solid.momentum(&self.state.v));
        [kinetic, self.solid.strain_energy(&self.state.u)]
    }
}

/// Zero where degrees of freedom are held.
pub(crate) fn clear(solid: &Solid, forces: &mut [f64]) {
    for (dof, force) in forces.iter_mut().enumerate() {
        if solid.is_held(dof) {
            *force = 0.0;
        }
    }
}

pub(crate) fn norm(v: &[f64]) -> f64 {
    dot(v, v).sqrt()
}

/// a · b
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
