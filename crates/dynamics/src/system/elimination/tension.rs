//! The stiffness of taut bodies against turns by the forces of their joints, for Newton's method.
//!
//! A force F on a body at an arm s turns with its joint and not with the body, whose turn by θ changes its moment by −K θ:
//!
//! ```text
//! K = Σ (F·s) 1 − sym(s Fᵀ),  clipped to its part that is not negative       in the axes of the body
//! ```
//!
//! Of a light link between heavy bodies it is far above κ²J. Eq. (J38) of `docs/method/systems.md`.

use nalgebra::{Matrix3, Vector3};

use crate::system::description::System;
use crate::system::stage::{Stage, vector};

/// K over κ²J of a body below which Newton's method does as well without it.
const SMALL: f64 = 0.1;
/// |K|/|J| over κ² from which it turns a body back many times in 1/κ.
const HELD: f64 = 100.0;
/// Sum of the forces of joints on a body over the sum of their sizes, up to which the mass of the body hardly matters.
const LIGHT: f64 = 1e-2;
/// Its change over its size and κ²J above which the matrices are made anew.
const FAR: f64 = 0.5;

/// K of each body, as the matrices have it and as it was last found.
#[derive(Debug, Clone)]
pub(in crate::system) struct Tension {
    pub frozen: Vec<Matrix3<f64>>,
    found: Vec<Matrix3<f64>>,
    /// |K|/|J| of light bodies, also where it is small beside κ²; zero of others.
    rates: Vec<f64>,
    /// The sum of the forces on each body, and that of their sizes.
    forces: Vec<(Vector3<f64>, f64)>,
}

impl Tension {
    /// No tension of a number of bodies.
    pub fn new(bodies: usize) -> Self {
        let none = vec![Matrix3::zeros(); bodies];
        let forces = vec![(Vector3::zeros(), 0.0); bodies];
        Self { frozen: none.clone(), found: none, rates: vec![0.0; bodies], forces }
    }

    /// Finds K at a stage by a part of the multipliers of its rows. True where it is far from what the matrices have.
    pub fn find(&mut self, system: &System, stage: &Stage, (multipliers, part): (&[f64], f64), kappa: f64) -> bool {
        self.found.fill(Matrix3::zeros());
        self.forces.fill((Vector3::zeros(), 0.0));
        let mut first = 0;
        for (markers, rows) in system.connections.joints.iter().flat_map(|joint| joint.groups()) {
            let own = first..first + rows.len();
            first = own.end;
            if rows.is_empty() {
                continue;
            }
            let arms = stage.places(system, markers).map(|place| place.arm);
            for (marker, arm) in markers.iter().zip(arms) {
                let Some(b) = marker.body() else { continue };
                let mut force = Vector3::zeros();
                for row in own.clone() {
                    let ends = stage.constraints.ends[row].iter().filter(|end| end.body == b);
                    ends.for_each(|end| force += part * multipliers[row] * vector(&end.entries, 0));
                }
                self.forces[b].0 += force;
                self.forces[b].1 += force.norm();
                let turned = arm * force.transpose();
                self.found[b] += Matrix3::identity() * force.dot(&arm) - 0.5 * (turned + turned.transpose());
            }
        }
        let mut is_far = false;
        let rates = self.rates.iter_mut().zip(&self.forces);
        let each = self.found.iter_mut().zip(&self.frozen).zip(&stage.inertia).zip(rates);
        for (((found, frozen), inertia), (rate, (force, sizes))) in each {
            let of_inertia = kappa * kappa * inertia.locked.norm();
            let is_light = !inertia.is_point() && force.norm() < LIGHT * sizes;
            *rate = if is_light { not_negative(found).norm() / inertia.locked.norm() } else { 0.0 };
            // A point mass does not turn; NaN is found where the forces are used.
            *found = if found.norm() > SMALL * of_inertia && found.norm().is_finite() && !inertia.is_point() {
                not_negative(found)
            } else {
                Matrix3::zeros()
            };
            is_far |= (*found - frozen).norm() > FAR * (of_inertia + frozen.norm());
        }
        is_far
    }

    /// True if a body is light beside what it hangs between, and turned back within a time 1/κ many times.
    pub fn holds(&self, body: usize, kappa: f64) -> bool {
        self.rates[body] > HELD * kappa * kappa
    }

    /// True if the matrices have K of a body.
    pub fn is_taut(&self) -> bool {
        self.frozen.iter().any(|tension| *tension != Matrix3::zeros())
    }

    /// The matrices are made with what was found.
    pub fn freeze(&mut self) {
        self.frozen.copy_from_slice(&self.found);
    }
}

/// The part of a symmetric matrix that is not negative.
fn not_negative(matrix: &Matrix3<f64>) -> Matrix3<f64> {
    let eigen = matrix.symmetric_eigen();
    let part = |k: usize| {
        let axis = eigen.eigenvectors.column(k);
        axis * axis.transpose() * eigen.eigenvalues[k].max(0.0)
    };
    part(0) + part(1) + part(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed form: the eigenvalues of a matrix beside a rotation.
    #[test]
    fn a_part_that_is_not_negative_has_no_other_eigenvalues() {
        let turn = nalgebra::Rotation3::from_euler_angles(0.3, -0.8, 1.1);
        let of = |values: [f64; 3]| turn * Matrix3::from_diagonal(&values.into()) * turn.transpose();
        assert!((not_negative(&of([2.0, -3.0, 0.5])) - of([2.0, 0.0, 0.5])).norm() < 1e-14);
    }
}
