//! The bodies and rows of a system at one time within a step.

use nalgebra::{Matrix3, Vector3};
use rigid_kin::{cross_matrix, f_inverse, transformation_matrix};

use crate::conservative::Evaluation;
use crate::conservative::{get, part, set};
use crate::equations::Equations;
use crate::error::RateError;
use crate::system::System;
use crate::system::constraints::Constraints;
use crate::system::inverse::{Inertia, Number, product};
use crate::system::marker::BodyPlace;

/// The start of a step: the numbers that its increments are counted from.
#[derive(Debug, Clone)]
pub(crate) struct Start {
    pub time: f64,
    /// Position of the origin, global; attitude; linear momentum, and angular momentum about the global origin, global; of
    /// each body.
    pub bodies: Vec<BodyStart>,
    /// q and p of all bodies, at the places of their coordinates.
    pub q: Vec<f64>,
    pub p: Vec<f64>,
}

/// The start of one body.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BodyStart {
    pub position: Vector3<f64>,
    pub body_from_global: Matrix3<f64>,
    pub momentum: Vector3<f64>,
    pub angular_momentum: Vector3<f64>,
}

/// A time within a step, with increments since its start.
#[derive(Debug, Clone)]
pub(crate) struct Stage {
    /// Δr (global), the rotation vector (body axes), Δq: of each body.
    pub x: Vec<f64>,
    /// ΔP, Δh about the global origin (global), Δp.
    pub y: Vec<f64>,
    pub evaluations: Vec<Evaluation>,
    pub constraints: Constraints,
    /// G v (m).
    pub constraint_rates: Vec<f64>,
    /// V, ω, q̇ of each body.
    pub velocities: Vec<f64>,
    /// x' and y' by the forces beside those of the joints.
    pub x_rates: Vec<f64>,
    pub y_rates: Vec<f64>,
    pub inertia: Vec<Inertia>,
    /// Transformation matrices of the bodies and positions of their origins.
    pub attitudes: Vec<Matrix3<f64>>,
    pub positions: Vec<Vector3<f64>>,
    /// q of all bodies.
    q: Vec<f64>,
    forces: Vec<f64>,
}

impl Stage {
    pub fn new(system: &System) -> Self {
        let (coordinates, rows) = (system.coordinates(), system.rows());
        let zeros = || vec![0.0; coordinates];
        let flexible = system.bodies.iter().map(Equations::flexible);
        Self {
            x: zeros(),
            y: zeros(),
            evaluations: system.bodies.iter().map(Equations::evaluation).collect(),
            constraints: Constraints::new(&system.joints, &system.first),
            constraint_rates: vec![0.0; rows],
            velocities: zeros(),
            x_rates: zeros(),
            y_rates: zeros(),
            inertia: flexible.map(Inertia::new).collect(),
            attitudes: vec![Matrix3::identity(); system.bodies.len()],
            positions: vec![Vector3::zeros(); system.bodies.len()],
            q: zeros(),
            forces: zeros(),
        }
    }

    /// Finds where the bodies are.
    pub fn place(&mut self, system: &System, start: &Start) {
        for (b, body) in start.bodies.iter().enumerate() {
            let first = system.first[b];
            let theta = vector(&self.x, first + 3);
            self.attitudes[b] = transformation_matrix(&theta) * body.body_from_global;
            self.positions[b] = body.position + vector(&self.x, first);
            for k in first + 6..system.first[b + 1] {
                self.q[k] = start.q[k] + self.x[k];
            }
        }
    }

    /// The place of a body.
    pub fn body_place<'a>(
        system: &System,
        positions: &[Vector3<f64>],
        attitudes: &[Matrix3<f64>],
        q: &'a [f64],
        b: usize,
    ) -> BodyPlace<'a> {
        BodyPlace {
            origin: positions[b],
            body_from_global: attitudes[b],
            q: &q[system.first[b] + 6..system.first[b + 1]],
        }
    }

    /// Finds g and, with `all`, G where the bodies have been placed.
    pub fn find_constraints(&mut self, system: &System, all: bool) {
        let Self { constraints, positions, attitudes, q, .. } = self;
        let place = |b| Self::body_place(system, positions, attitudes, q, b);
        if all {
            constraints.find(&system.joints, place);
        } else {
            constraints.find_residuals(&system.joints, place);
        }
    }

    /// Finds velocities, rates, g and G at a time; laws with branches are taken as they are at the branch time.
    pub fn evaluate(&mut self, system: &System, start: &Start, times: [f64; 2]) -> Result<(), RateError> {
        self.place(system, start);
        for (b, (body, from)) in system.bodies.iter().zip(&start.bodies).enumerate() {
            let (first, end) = (system.first[b], system.first[b + 1]);
            let e = &mut self.evaluations[b];
            let (position, attitude) = (self.positions[b], self.attitudes[b]);
            let momentum = from.momentum + vector(&self.y, first);
            let angular_momentum = from.angular_momentum + vector(&self.y, first + 3);
            let pi = attitude * (angular_momentum - position.cross(&momentum));
            let mut slow = *e.at.slow();
            set(&mut slow, part::THETA, &vector(&self.x, first + 3));
            set(&mut slow, part::POSITION, &position);
            set(&mut slow, part::MOMENTUM, &momentum);
            set(&mut slow, part::PI, &pi);
            e.at.set_slow(&slow);
            let [q, p] = e.at.modes_mut();
            q.copy_from_slice(&self.q[first + 6..end]);
            for (p, k) in p.iter_mut().zip(first + 6..) {
                *p = start.p[k] + self.y[k];
            }
            body.evaluate(times, &from.body_from_global, e)?;
            let e = &*e;
            let rates = e.rates.slow();
            put(&mut self.velocities, first, &get(rates, part::POSITION));
            put(&mut self.velocities, first + 3, &e.omega_body);
            self.velocities[first + 6..end].copy_from_slice(&e.modal_velocity);
            let force = get(rates, part::MOMENTUM);
            let moment = get(rates, part::PI) - pi.cross(&e.omega_body);
            put(&mut self.y_rates, first, &force);
            put(&mut self.y_rates, first + 3, &(position.cross(&force) + attitude.tr_mul(&moment)));
            for k in 0..end - first - 6 {
                self.y_rates[first + 6 + k] = e.rates.p()[k] + body.linear_rate(k, e.at.q()[k], e.at.p()[k]);
            }
            let inertia = &mut self.inertia[b];
            inertia.mass = body.mass();
            inertia.locked = e.locked_inertia;
            inertia.locked_inverse = e.locked_inertia.try_inverse().ok_or(RateError::Inertia)?;
            body.copy_coupling(e, &mut inertia.coupling);
        }
        self.find_constraints(system, true);
        self.constraints.rates(&self.velocities, &mut self.constraint_rates);
        Ok(())
    }

    /// Finds x' of the velocities and M⁻¹Gᵀ of `multipliers`.
    pub fn find_x_rates(&mut self, system: &System, multipliers: &[f64]) -> Result<(), RateError> {
        self.forces.fill(0.0);
        self.constraints.add_forces(multipliers, &mut self.forces);
        for (b, inertia) in self.inertia.iter().enumerate() {
            let (first, end) = (system.first[b], system.first[b + 1]);
            inertia.solve(&mut self.forces[first..end]);
            for k in first..end {
                self.x_rates[k] = self.velocities[k] + self.forces[k];
            }
            let [theta, omega] = [&self.x, &self.x_rates].map(|list| vector(list, first + 3));
            let rate = f_inverse(&theta, &omega).map_err(RateError::Turn)?;
            put(&mut self.x_rates, first + 3, &rate);
        }
        Ok(())
    }

    /// out = y' with the forces of `multipliers`.
    pub fn find_y_rates(&mut self, system: &System, multipliers: &[f64], out: &mut [f64]) {
        self.forces.fill(0.0);
        self.constraints.add_forces(multipliers, &mut self.forces);
        for b in 0..system.bodies.len() {
            let (first, end) = (system.first[b], system.first[b + 1]);
            about_global_origin(&mut self.forces[first..end], &self.positions[b], &self.attitudes[b]);
        }
        out.iter_mut().zip(self.y_rates.iter().zip(&self.forces)).for_each(|(out, (rate, force))| *out = rate + force);
    }

    /// Removes the part of the velocities that the rows forbid, and the momenta that go with it, by `solve` of A λ = G v.
    /// Returns the largest rate that was left.
    pub fn project_velocities(
        &mut self,
        system: &System,
        momenta: &mut [f64],
        solve: impl Fn(&mut [f64]),
    ) -> f64 {
        let mut left = f64::INFINITY;
        for _ in 0..MAX_PROJECTIONS {
            self.constraints.rates(&self.velocities, &mut self.constraint_rates);
            let largest = self.constraint_rates.iter().fold(0.0_f64, |most, rate| most.max(rate.abs()));
            if largest >= 0.5 * left || largest == 0.0 {
                return largest.min(left);
            }
            left = largest;
            solve(&mut self.constraint_rates);
            self.constraint_rates.iter_mut().for_each(|multiplier| *multiplier = -*multiplier);
            self.forces.fill(0.0);
            self.constraints.add_forces(&self.constraint_rates, &mut self.forces);
            for (b, inertia) in self.inertia.iter().enumerate() {
                let (first, end) = (system.first[b], system.first[b + 1]);
                let change = &mut self.forces[first..end];
                momenta[first..end].iter_mut().zip(&*change).for_each(|(momentum, change)| *momentum += change);
                inertia.solve(change);
                self.velocities[first..end].iter_mut().zip(&*change).for_each(|(velocity, change)| *velocity += change);
            }
        }
        left
    }
}

/// Passes of a projection before it is left as it is.
const MAX_PROJECTIONS: usize = 20;

/// Turns a generalised force (moment about the body's origin, body axes) into one about the global origin, global.
pub(crate) fn about_global_origin<T: Number>(
    force: &mut [T],
    position: &Vector3<f64>,
    body_from_global: &Matrix3<f64>,
) {
    let [f, moment] = [0, 3].map(|first| Vector3::new(force[first], force[first + 1], force[first + 2]));
    let turned = product(&body_from_global.transpose(), &moment) + product(&cross_matrix(position), &f);
    force[3..6].copy_from_slice(turned.as_slice());
}

/// The inverse of [`about_global_origin`].
pub(crate) fn about_body_origin<T: Number>(force: &mut [T], position: &Vector3<f64>, body_from_global: &Matrix3<f64>) {
    let [f, moment] = [0, 3].map(|first| Vector3::new(force[first], force[first + 1], force[first + 2]));
    let turned = product(body_from_global, &(moment - product(&cross_matrix(position), &f)));
    force[3..6].copy_from_slice(turned.as_slice());
}

pub(crate) fn vector(list: &[f64], first: usize) -> Vector3<f64> {
    Vector3::new(list[first], list[first + 1], list[first + 2])
}

pub(crate) fn put(list: &mut [f64], first: usize, value: &Vector3<f64>) {
    list[first..first + 3].copy_from_slice(value.as_slice());
}
