//! Reactions of the joints and accelerations of the bodies, where a system is: the multipliers of index 1.
//!
//! ```text
//! λ = −A⁻¹ (G a + Ġ v + ġ_t),     A = G M⁻¹ Gᵀ,     a: accelerations without the joints
//! ```
//!
//! Eqs. (J10) of `docs/method/systems.md`. Ġ v + ġ_t is found by differences along the motion.

mod observation;
mod wrenches;

use crate::body::shapes::PointShapes;
use crate::conservative::{get, part};
use crate::equations::Equations;
use crate::error::RateError;
use crate::observation::Observation;
use crate::system::description::System;
use crate::system::elimination::matrices::Matrices;
use crate::system::elimination::patterns::Patterns;
use crate::system::marker::Marker;
use crate::system::marker::motion::MarkerWrench;
use crate::system::radau::SystemMotion;
use crate::system::stage::{Stage, Start, put, vector};

/// Time of the differences, relative to a turn of the fastest body by one radian.
const SHORT: f64 = 1e-4;

impl SystemMotion {
    /// Finds the reactions of the joints and the accelerations of the bodies where the system is, for [`Self::observe`] and
    /// [`Self::reaction`].
    ///
    /// # Errors
    /// [`RateError`] where the inertia of a body is singular.
    pub fn find_reactions(&mut self) -> Result<(), RateError> {
        self.begin();
        self.evaluate_first(self.time)?;
        let after = self.time + short_time(&self.system, &self.first.velocities);
        let Self { first, stages: [scratch, ..], system, start, matrices, patterns, reactions, .. } = self;
        let times = [start.time, after];
        Index1 { system, start, matrices, patterns, scratch }.find(first, times, reactions)?;
        let forces = &mut first.x_rates;
        forces.fill(0.0);
        first.constraints.add_forces(reactions, forces);
        for (b, body) in system.bodies.iter().enumerate() {
            let forces = &forces[system.first[b]..system.first[b + 1]];
            let force_global = first.attitudes[b].tr_mul(&vector(forces, 0));
            body.add_forces([&force_global, &vector(forces, 3)], &forces[6..], &mut first.evaluations[b]);
        }
        Ok(())
    }

    /// Fills `out` with the motion of a body, and that of points on it, after [`Self::find_reactions`].
    ///
    /// # Errors
    /// [`RateError`] where the inertia of the body is singular.
    pub fn observe(&mut self, body: usize, points: &[PointShapes], out: &mut Observation) -> Result<(), RateError> {
        let Self { system, bodies, first, .. } = self;
        system.bodies[body].observe(&bodies[body], &mut first.evaluations[body], points, out)
    }

    /// Force and moment of a joint on its second marker, after [`Self::find_reactions`]; on the first they are the opposite, about the same
    /// point.
    pub fn reaction(&self, joint: usize) -> MarkerWrench {
        let Self { system, first, .. } = self;
        let before: usize = system.connections.joints[..joint].iter().map(|joint| joint.row_count()).sum();
        let joint = &system.connections.joints[joint];
        let place = |marker: &Marker| marker.place(marker.body().map(|b| first.body_place(system, b)).as_ref());
        let driven = joint.driven_at([self.time(); 2]);
        let (mut sum, mut multipliers) = (MarkerWrench::default(), self.reactions[before..].iter());
        let about = place(&joint.markers[1]).position;
        for (markers, rows) in joint.groups().filter(|(_, rows)| !rows.is_empty()) {
            let places = markers.each_ref().map(place);
            let arm = places[1].position - about;
            for row in rows {
                let wrench = row.wrench(places.each_ref(), driven);
                let multiplier = multipliers.next().copied().unwrap_or_default();
                sum.force_global += wrench.force * multiplier;
                sum.moment_global += (wrench.moments[1] + arm.cross(&wrench.force)) * multiplier;
            }
        }
        sum
    }

    /// Power of the drive and the motors of a joint now, after [`Self::find_reactions`].
    pub fn drive_power(&self, joint: usize) -> f64 {
        let Self { system, first, .. } = self;
        let joints = &system.connections.joints;
        let before: usize = joints[..joint].iter().map(|joint| joint.row_count()).sum();
        let rows = before..before + joints[joint].row_count();
        let of_row = |(multiplier, rate): (&f64, &f64)| -multiplier * rate;
        let of_drive: f64 =
            self.reactions[rows.clone()].iter().zip(&first.constraints.own_rates[rows]).map(of_row).sum();
        let forces = system.connections.joint_forces().zip(&first.joint_powers);
        of_drive + forces.filter(|((number, ..), _)| *number == joint).map(|(_, power)| power.motor).sum::<f64>()
    }

    /// The force that a coupling puts on its sum, after [`Self::find_reactions`]: times the factor of a coordinate, its force or moment
    /// there.
    pub fn coupling_force(&self, coupling: usize) -> f64 {
        let joints = &self.system.connections.joints;
        self.reactions[joints.iter().map(|joint| joint.row_count()).sum::<usize>() + coupling]
    }
}

/// A motion from a place: increments since the start of a step, velocities, and the rates of the increments.
#[derive(Debug, Clone, Copy)]
pub(super) struct Passing<'a> {
    pub x: &'a [f64],
    pub x_rates: &'a [f64],
    pub velocities: &'a [f64],
}

/// Finds multipliers of index 1.
pub(super) struct Index1<'a> {
    pub system: &'a System,
    pub start: &'a Start,
    pub matrices: &'a mut Matrices,
    pub patterns: &'a Patterns,
    pub scratch: &'a mut Stage,
}

impl Index1<'_> {
    /// λ at a time, by the branch of another, where a stage has been evaluated and has x' of its velocities. The rates of its bodies
    /// then have the forces of elements and of joints along their coordinates.
    pub fn find(&mut self, stage: &mut Stage, times: [f64; 2], out: &mut Vec<f64>) -> Result<(), RateError> {
        let Stage { x, x_rates, velocities, .. } = &*stage;
        let passing = Passing { x, x_rates, velocities };
        find_row_accelerations((self.system, self.start), self.scratch, passing, times, out);
        let Self { system, matrices, patterns, scratch, .. } = self;
        if !matrices.factor_mass(patterns, stage) {
            return Err(RateError::Inertia);
        }
        for (b, body) in system.bodies.iter().enumerate() {
            let own = system.first[b]..system.first[b + 1];
            let forces = &stage.element_forces[own.clone()];
            let force_global = stage.attitudes[b].tr_mul(&vector(forces, 0));
            let e = &mut stage.evaluations[b];
            body.add_forces([&force_global, &vector(forces, 3)], &forces[6..], e);
            let spin_rate = body.find_accelerations(0.0, e)?;
            let velocities = &stage.velocities[own.clone()];
            let [velocity, omega] = [vector(velocities, 0), vector(velocities, 3)];
            let acceleration = stage.attitudes[b] * get(e.rates.slow(), part::MOMENTUM) / body.mass();
            let accelerations = &mut scratch.x_rates[own];
            // V has the axes of the body, which turn.
            put(accelerations, 0, &(acceleration - omega.cross(&velocity)));
            put(accelerations, 3, &spin_rate);
            accelerations[6..].copy_from_slice(&e.acceleration);
        }
        stage.constraints.add_rates(1.0, &scratch.x_rates, out);
        out.iter_mut().for_each(|sum| *sum = -*sum);
        matrices.of_mass.solve(&patterns.rows, out);
        Ok(())
    }
}

/// A time in which nothing turns far.
pub(super) fn short_time(system: &System, velocities: &[f64]) -> f64 {
    let omegas = system.first[..system.bodies.len()].iter().map(|first| vector(velocities, first + 3));
    SHORT / omegas.map(|omega| omega.norm()).fold(0.0, f64::max).max(1.0)
}

/// out = Ġ v + ġ_t for a motion at a time, by the branch of another.
pub(super) fn find_row_accelerations(
    (system, start): (&System, &Start),
    scratch: &mut Stage,
    Passing { x, x_rates, velocities }: Passing<'_>,
    times: [f64; 2],
    out: &mut Vec<f64>,
) {
    let short = short_time(system, velocities);
    out.clear();
    out.resize(system.rows(), 0.0);
    for sign in [1.0, -1.0] {
        for (passed, (x, rate)) in scratch.x.iter_mut().zip(x.iter().zip(x_rates)) {
            *passed = x + sign * short * rate;
        }
        scratch.place(system, start);
        scratch.find_constraints(system, start, [times[0] + sign * short, times[1]]);
        scratch.constraints.rates(velocities, &mut scratch.constraint_rates);
        out.iter_mut().zip(&scratch.constraint_rates).for_each(|(sum, rate)| *sum += sign * rate / (2.0 * short));
    }
}
