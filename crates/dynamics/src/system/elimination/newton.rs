//! One pass of Newton's method: Eqs. (J8) of `docs/method/systems.md`.

use nalgebra::{Matrix3, Vector3};

use crate::system::description::System;
use crate::system::elimination::inverse::product;
use crate::system::elimination::joint_matrix::Times;
use crate::system::elimination::matrices::{Matrices, NewtonMatrix};
use crate::system::elimination::number::Number;
use crate::system::elimination::patterns::Patterns;
use crate::system::stage::{Stage, vector};

/// Right-hand sides, which become changes.
#[derive(Debug, Clone)]
pub(in crate::system) struct Solution<T> {
    pub x: Vec<T>,
    pub y: Vec<T>,
    pub lambda: Vec<T>,
    pub mu: Vec<T>,
    /// dV, and a list of the same length.
    velocity: Vec<T>,
    of_mu: Vec<T>,
}

impl<T: Number> Solution<T> {
    pub fn new(coordinates: usize, patterns: &Patterns) -> Self {
        let zeros = |n| vec![T::from_real(0.0); n];
        Self {
            x: zeros(coordinates),
            y: zeros(coordinates),
            lambda: zeros(patterns.newton.len()),
            mu: zeros(patterns.rows.len()),
            velocity: zeros(coordinates),
            of_mu: zeros(coordinates),
        }
    }

    /// Makes all right-hand sides zero.
    pub fn clear(&mut self) {
        for list in [&mut self.x, &mut self.y, &mut self.lambda, &mut self.mu] {
            list.fill(T::from_real(0.0));
        }
    }
}

/// The part that both solutions of a Newton pass share.
#[derive(Clone, Copy)]
pub(in crate::system) struct Frozen<'a> {
    pub system: &'a System,
    pub stage: &'a Stage,
    pub patterns: &'a Patterns,
    pub matrices: &'a Matrices,
}

impl Frozen<'_> {
    /// The Newton system of one κ, Eqs. (J8) and (J14): right-hand sides become changes. Those of compliant rows are zero, and become
    /// changes of their forces.
    pub fn solve<T: Number + Times<T>>(self, solution: &mut Solution<T>, matrix: &NewtonMatrix<T>) {
        let Self { system, stage: Stage { constraints, inertia, .. }, patterns, matrices } = self;
        let NewtonMatrix { kappa, bodies: inverses, rows: of_z } = matrix;
        let (kappa, rows) = (*kappa, patterns.rows.len());
        let Solution { x, y, lambda, mu, velocity, of_mu } = solution;
        let bodies = || (0..system.bodies.len()).map(|b| (b, system.first[b]..system.first[b + 1]));
        // t = κ Rg − G RX, and A μ = t − Rv
        lambda.iter_mut().for_each(|lambda| *lambda *= kappa);
        constraints.add_rates(-1.0, x, lambda);
        mu.iter_mut().zip(&*lambda).for_each(|(mu, t)| *mu = *t - *mu);
        matrices.of_mass.solve(&patterns.rows, mu);
        // b = RY − Λ RX/κ + D (M⁻¹Gᵀμ)
        of_mu.fill(T::from_real(0.0));
        constraints.add_forces(mu, of_mu);
        velocity.copy_from_slice(of_mu);
        for (b, own) in bodies() {
            let body = &system.bodies[b];
            inertia[b].solve(&mut velocity[own.clone()]);
            let modes = own.start + 6..own.end;
            if let Some(bent) = &inertia[b].bent {
                bent.add_stiffness(-kappa.recip(), &x[modes.clone()], &mut y[modes.clone()]);
            }
            for (k, at) in modes.enumerate() {
                let (omega, zeta) = (body.circular_frequencies[k], body.damping_ratios[k]);
                let forces = velocity[at].scale(2.0 * zeta * omega) - x[at].scale(omega * omega) / kappa;
                y[at] += forces;
            }
            // Of taut bodies −K RX/κ beside it.
            let tension = &inverses[b].tension;
            if *tension != Matrix3::zeros() {
                let turned = product(tension, &Vector3::from_fn(|i, _| x[own.start + 3 + i]));
                (0..3).for_each(|i| y[own.start + 3 + i] -= turned[i] / kappa);
            }
        }
        // −(k/κ W RX − c W M⁻¹Gᵀμ) / (k/κ + c) of compliant rows
        let compliant = matrices.compliant.iter().zip(&constraints.ends[rows..]);
        for (t, (row, ends)) in lambda[rows..].iter_mut().zip(compliant).filter(|(_, (row, _))| !row.is_slack()) {
            let mut rate = T::from_real(0.0);
            ends.iter().for_each(|end| end.add_rate(1.0, velocity, &mut rate));
            *t = ((*t / kappa).scale(row.stiffness) + rate.scale(row.damping)) / row.resistance(kappa);
        }
        // (G Z⁻¹ Gᵀ) λ' = t − G Z⁻¹ b
        velocity.copy_from_slice(y);
        bodies().for_each(|(b, own)| inverses[b].apply(&mut velocity[own]));
        constraints.add_rates(-1.0, velocity, lambda);
        of_z.solve(&patterns.newton, lambda);
        // dV = Z⁻¹ (b + Gᵀλ'), dX = (RX + dV)/κ, dY = M dV − Gᵀμ
        constraints.add_forces(lambda, y);
        for (b, own) in bodies() {
            inverses[b].apply(&mut y[own.clone()]);
            own.clone().for_each(|k| x[k] = (x[k] + y[k]) / kappa);
            inertia[b].multiply(&mut y[own.clone()]);
            own.for_each(|k| y[k] -= of_mu[k]);
        }
        lambda.iter_mut().zip(&*mu).for_each(|(lambda, mu)| *lambda -= kappa * *mu);
    }
}

/// Length over the size of the largest body over which a change of place of a point mass counts.
const OF_POINT: f64 = 1e-2;

/// Sizes of a change of positions: the largest root mean square of a body, with its mass, relative to its radius of gyration, of a point
/// mass to a part of the size of the largest body; and the energy of the change, if it comes about within a step, and of its strain.
pub(in crate::system) fn sizes(system: &System, x: &[f64], [h, size]: [f64; 2]) -> [f64; 2] {
    let (mut largest, mut energy) = (0.0, 0.0);
    for (b, body) in system.bodies.iter().enumerate() {
        let own = &x[system.first[b]..system.first[b + 1]];
        let [moved, turned] = [0, 3].map(|first| vector(own, first));
        let inertia = body.undeformed_inertia();
        let square = body.mass() * moved.norm_squared()
            + turned.dot(&(inertia * turned))
            + own[6..].iter().map(|q| q * q).sum::<f64>();
        let of_size = match body.is_point() {
            true => body.mass() * (OF_POINT * size).powi(2),
            false => 0.5 * inertia.trace(),
        };
        let moved = (square / of_size).sqrt();
        // A NaN stays one.
        largest = if moved <= largest { largest } else { moved };
        let strain = own[6..].iter().zip(&body.circular_frequencies).map(|(q, omega)| (omega * q).powi(2)).sum::<f64>();
        energy += 0.5 * (square / (h * h) + strain);
    }
    [largest, energy]
}
