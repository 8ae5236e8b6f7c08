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
use nalgebra::{DMatrix, DVector, Vector6};

use crate::conservative::{ConservativeBody, get, part};
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
        self.judge();
        let after = self.time + short_time(&self.system, &self.first.velocities);
        let Self { first, stages: [scratch, ..], system, start, matrices, patterns, reactions, .. } = self;
        let times = [start.time, after];
        Index1 { system, start, matrices, patterns, scratch }.find(first, times, reactions)?;
        self.share_reactions();
        let Self { first, system, reactions, .. } = self;
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

    /// Shares what rows that imply each other bear so that Σ |f|² + |m|²/L² over the joints is least: by geometry alone, whatever the
    /// masses, the units and the order of the joints, Eq. (J36).
    fn share_reactions(&mut self) {
        let Self { first, system, judgement, reactions, .. } = self;
        let Some(known) = judgement else { return };
        if known.rank.idle.is_empty() || !known.is_of_now() {
            return;
        }
        let wrenches = first.wrenches_of_rows(system, known.tree.size);
        let joint_of_row = &known.tree.joint_of_row;
        // Wrenches of joints by a list of multipliers.
        let sums = |multipliers: &[f64]| -> Vec<f64> {
            let mut sums = vec![Vector6::zeros(); system.connections.groups().count()];
            for ((multiplier, wrench), joint) in multipliers.iter().zip(&wrenches).zip(joint_of_row) {
                sums[*joint] += wrench * *multiplier;
            }
            sums.iter().flat_map(|sum| sum.iter().copied().collect::<Vec<f64>>()).collect()
        };
        let idle: Vec<DVector<f64>> = known.rank.idle.iter().map(|u| DVector::from_vec(sums(u))).collect();
        let now = DVector::from_vec(sums(reactions));
        let count = idle.len();
        let gram = DMatrix::from_fn(count, count, |i, k| idle[i].dot(&idle[k]));
        let right = DVector::from_fn(count, |i, _| idle[i].dot(&now));
        let Some(parts) = gram.cholesky().map(|factor| factor.solve(&right)) else { return };
        for (u, part) in known.rank.idle.iter().zip(parts.iter()) {
            reactions.iter_mut().zip(u).for_each(|(reaction, u)| *reaction -= part * u);
        }
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
        scratch.constraints.residuals.copy_from_slice(out);
        matrices.of_mass.solve(&patterns.rows, out);
        if is_uneven(system) {
            (0..SWEEPS).for_each(|sweep| self.refine(stage, sweep == 0, out));
        }
        Ok(())
    }

    /// A sweep of refinement of M a = Gᵀλ, G a = t: the factor of G M⁻¹Gᵀ alone loses digits where light bodies bear heavy ones.
    fn refine(&mut self, stage: &Stage, is_first: bool, lambda: &mut [f64]) {
        let Self { system, matrices, patterns, scratch, .. } = self;
        let Stage { x: accelerations, y: left, velocities: impulse, constraints, constraint_rates: change, .. } =
            &mut **scratch;
        let own = |b: usize| system.first[b]..system.first[b + 1];
        left.fill(0.0);
        stage.constraints.add_forces(lambda, left);
        if is_first {
            accelerations.copy_from_slice(left);
            stage.inertia.iter().enumerate().for_each(|(b, of)| of.solve(&mut accelerations[own(b)]));
        }
        impulse.copy_from_slice(accelerations);
        stage.inertia.iter().enumerate().for_each(|(b, of)| of.multiply(&mut impulse[own(b)]));
        left.iter_mut().zip(&*impulse).for_each(|(left, of)| *left -= of);
        // t − G a − G M⁻¹ (Gᵀλ − M a)
        impulse.copy_from_slice(left);
        stage.inertia.iter().enumerate().for_each(|(b, of)| of.solve(&mut impulse[own(b)]));
        change.copy_from_slice(&constraints.residuals);
        stage.constraints.add_rates(-1.0, accelerations, change);
        stage.constraints.add_rates(-1.0, impulse, change);
        matrices.of_mass.solve(&patterns.rows, change);
        lambda.iter_mut().zip(&*change).for_each(|(lambda, change)| *lambda += change);
        stage.constraints.add_forces(change, left);
        stage.inertia.iter().enumerate().for_each(|(b, of)| of.solve(&mut left[own(b)]));
        accelerations.iter_mut().zip(&*left).for_each(|(sum, change)| *sum += change);
    }
}

/// Sweeps of refinement, and the ratio of masses or of moments of inertia from which they are done.
const SWEEPS: usize = 2;
const UNEVEN: f64 = 1e3;

/// True if some bodies are much lighter than others.
fn is_uneven(system: &System) -> bool {
    let ratio = |of: fn(&ConservativeBody) -> f64| {
        let all = || system.bodies.iter().map(of);
        all().fold(0.0, f64::max) / all().fold(f64::INFINITY, f64::min)
    };
    ratio(ConservativeBody::mass) > UNEVEN || ratio(|body| body.undeformed_inertia().trace()) > UNEVEN
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
