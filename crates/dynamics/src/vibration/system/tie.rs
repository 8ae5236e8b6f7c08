//! Joints and force elements in the linearised equations: Eqs. (L3) to (L5) of `docs/method/systems.md`.

use faer::Mat;
use nalgebra::Vector3;

use crate::conservative::ConservativeBody;
use crate::system::description::System;
use crate::system::joint::change::{FrameChange, WrenchChange};
use crate::system::joint::coordinate::Coordinate;
use crate::system::joint::force::JointForce;
use crate::system::joint::row::Row;
use crate::system::joint::wrench::RowWrench;
use crate::system::marker::motion::{MarkerChange, MarkerMotion, MarkerWrench};
use crate::system::marker::tangent::MarkerTangent;
use crate::system::marker::{Marker, MarkerPlace};
use crate::vibration::system::blocks::Blocks;
use crate::vibration::system::configuration::Configuration;

/// Part of a change of a wrench that is rounding.
const ROUNDING: f64 = 1e-6;

/// A change of a wrench below this part of what its springs do is rounding, and a stiffness below this part of what it was is one that others leave.
const LEFT: f64 = 1e-14;
const TAKEN: f64 = 1e-6;

/// Some markers with the forces between them, to first order. Entries of lists and matrices are those of the markers one after
/// another, six each: displacement and turn, or force and moment, global.
#[derive(Debug, Clone)]
pub(crate) struct Tie {
    ends: Vec<Option<TieEnd>>,
    /// The largest radius of gyration of the bodies.
    length: f64,
    wrenches: Vec<[Vector3<f64>; 2]>,
    /// Velocities and angular velocities of the markers.
    velocities: Vec<f64>,
    /// Changes of the wrenches by displacements and turns, at the same velocities.
    by_motion: Mat<f64>,
    /// Changes of the wrenches by velocities and angular velocities.
    by_velocity: Mat<f64>,
}

/// Forces of ties on a body, with the stiffening by their stress.
#[derive(Debug, Clone)]
pub(crate) struct Borne {
    /// The largest force and moment on one marker.
    pub force: f64,
    pub moment: f64,
    /// The part of K that is the stress of these forces (nf×nf).
    pub stiffening: Mat<f64>,
}

impl Borne {
    /// Nothing, on a body with this number of modes.
    pub fn nothing(modes: usize) -> Self {
        Self { force: 0.0, moment: 0.0, stiffening: Mat::zeros(modes, modes) }
    }
}

/// A marker that is not on the ground.
#[derive(Debug, Clone)]
struct TieEnd {
    body: usize,
    first: usize,
    tangent: MarkerTangent,
}

/// Matrices over all coordinates that ties add to.
pub(crate) struct Sums<'a> {
    /// Generalised forces.
    pub forces: &'a mut Vec<f64>,
    /// Their changes by place, at the same velocities, and by velocities.
    pub by_place: &'a mut Blocks,
    pub by_velocity: &'a mut Blocks,
}

impl Tie {
    /// No forces yet.
    pub fn new<'m>(system: &System, at: &Configuration, markers: impl Iterator<Item = &'m Marker>) -> Self {
        let end = |marker: &Marker| {
            let body = marker.body()?;
            let of = &at.bodies[body];
            let tangent = marker.tangent(&at.place(body), of.q.len(), [&of.velocity, &of.omega]);
            Some((TieEnd { body, first: system.first[body], tangent }, &of.velocity, &of.omega))
        };
        let mut ends = Vec::new();
        let mut velocities = Vec::new();
        let mut length = 0.0_f64;
        for marker in markers {
            length = length.max(system.length_at(marker));
            let end = end(marker);
            velocities.extend((0..6).map(|i| {
                end.as_ref().map_or(0.0, |(end, velocity, omega)| {
                    (0..3)
                        .map(|k| end.tangent.motion[(i, k)] * velocity[k] + end.tangent.motion[(i, 3 + k)] * omega[k])
                        .sum()
                })
            }));
            ends.push(end.map(|(end, ..)| end));
        }
        let size = 6 * ends.len();
        Self {
            wrenches: vec![[Vector3::zeros(); 2]; ends.len()],
            velocities,
            by_motion: Mat::zeros(size, size),
            by_velocity: Mat::zeros(size, size),
            ends,
            length,
        }
    }

    /// Adds a force along a scalar: its wrench and its change, times the force, and the slopes of the force over the scalar and over
    /// its rate.
    fn add_scalar(
        &mut self,
        wrench: &RowWrench,
        change: impl Fn([&FrameChange; 2]) -> WrenchChange,
        force: f64,
        slopes: [f64; 2],
    ) {
        let on = list(wrench.on_both());
        for (sum, [force_on, moment_on]) in self.wrenches.iter_mut().zip(wrench.on_both()) {
            sum[0] += force_on * force;
            sum[1] += moment_on * force;
        }
        for column in 0..12 {
            let mut frames = [FrameChange::default(); 2];
            let frame = &mut frames[column / 6];
            let unit = Vector3::ith(column % 3, 1.0);
            if column % 6 < 3 {
                frame.displacement = unit
            } else {
                frame.turn = unit
            }
            let changed = list(change(frames.each_ref()).on_both());
            let faster: f64 = changed.iter().zip(&self.velocities).map(|(change, velocity)| change * velocity).sum();
            let scalar = slopes[0] * on[column] + slopes[1] * faster;
            for row in 0..12 {
                self.by_motion[(row, column)] += force * changed[row] + scalar * on[row];
                self.by_velocity[(row, column)] += slopes[1] * on[column] * on[row];
            }
        }
    }

    /// Rows of a joint, driven to this value with this rate, with these multipliers.
    pub fn add_rows(&mut self, rows: &[Row], places: &[MarkerPlace; 2], driven: [f64; 2], multipliers: &[f64]) {
        let length = self.length;
        for (row, multiplier) in rows.iter().zip(multipliers) {
            let wrench = row.wrench(places.each_ref(), driven);
            let change = |changes: [&FrameChange; 2]| row.wrench_change(places.each_ref(), driven[0], changes, length);
            self.add_scalar(&wrench, change, *multiplier, [0.0; 2]);
        }
    }

    /// A force along a coordinate of a joint, with its slopes over the coordinate and its rate.
    pub fn add_coordinate(
        &mut self,
        coordinate: Coordinate,
        places: &[MarkerPlace; 2],
        turn: f64,
        law: impl FnOnce([f64; 2]) -> (f64, [f64; 2]),
    ) {
        let wrench = coordinate.wrench(places.each_ref(), turn);
        let rate = list(wrench.on_both()).iter().zip(&self.velocities).map(|(on, velocity)| on * velocity).sum();
        let (force, slopes) = law([wrench.residual, rate]);
        let change = |changes: [&FrameChange; 2]| coordinate.wrench_change(places.each_ref(), changes);
        self.add_scalar(&wrench, change, force, slopes);
    }

    /// A force of a joint along its coordinate.
    pub fn add_joint_force(
        &mut self,
        (coordinate, force): (Coordinate, &JointForce),
        places: &[MarkerPlace; 2],
        turn: f64,
        time: f64,
    ) {
        self.add_coordinate(coordinate, places, turn, |at| {
            (force.at(at, [time; 2]).sum(), force.slopes(at, [time; 2]))
        });
    }

    /// A force element, by its number.
    pub fn of_element(system: &System, at: &Configuration, number: usize) -> Self {
        let markers = &system.connections.element_markers[number];
        let mut tie = Self::new(system, at, markers.iter());
        tie.add_element(system, number, at);
        tie
    }

    fn add_element(&mut self, system: &System, number: usize, at: &Configuration) {
        let element = &*system.connections.elements[number];
        let markers = &system.connections.element_markers[number];
        let times = [at.time; 2];
        let motions: Vec<MarkerMotion> = markers
            .iter()
            .enumerate()
            .map(|(k, marker)| {
                let place = marker.place(marker.body().map(|b| at.place(b)).as_ref());
                let velocity = |first: usize| Vector3::from_fn(|i, _| self.velocities[6 * k + first + i]);
                let motion = MarkerMotion {
                    position_global: place.position,
                    axes_global: place.axes,
                    velocity_global: velocity(0),
                    omega_global: velocity(3),
                };
                let motion = system.motion_for(number, marker, motion, at.time);
                let carried = marker.body().map_or_else(Vector3::zeros, |body| at.bodies[body].carried);
                let velocity = if element.is_relative() { velocity(0) } else { velocity(0) + carried };
                MarkerMotion { velocity_global: velocity, ..motion }
            })
            .collect();
        let mut wrenches = vec![MarkerWrench::default(); markers.len()];
        element.apply(times, &motions, &mut wrenches);
        for (sum, wrench) in self.wrenches.iter_mut().zip(&wrenches) {
            sum[0] += wrench.force_global;
            sum[1] += wrench.moment_global;
        }
        for column in 0..12 * markers.len() {
            let (marker, part) = (column / 12, column % 12);
            let mut by = vec![MarkerChange::default(); markers.len()];
            let unit = Vector3::ith(part % 3, 1.0);
            match part / 3 {
                0 => by[marker].displacement_global = unit,
                1 => by[marker].turn_global = unit,
                2 => by[marker].velocity_global = unit,
                _ => by[marker].omega_global = unit,
            }
            let mut changes = vec![MarkerWrench::default(); markers.len()];
            element.differentiate(times, &motions, &by, &mut changes);
            let (to, at) = match part {
                0..6 => (&mut self.by_motion, 6 * marker + part),
                _ => (&mut self.by_velocity, 6 * marker + part - 6),
            };
            for (k, change) in changes.iter().enumerate() {
                for i in 0..3 {
                    to[(6 * k + i, at)] += change.force_global[i];
                    to[(6 * k + 3 + i, at)] += change.moment_global[i];
                }
            }
        }
    }

    /// Parts its springs from all else: over all coordinates (n), rows b of changes of place that strain a spring, of which each adds b bᵀ to K. The tie
    /// keeps what they do not hold, such as the turn of its forces. Slow motions that strain none have then no rounding of stiff ones.
    pub fn take_springs(&mut self, n: usize) -> Vec<Vec<f64>> {
        let size = 6 * self.ends.len();
        let own: Vec<f64> = (0..size).map(|i| -self.by_motion[(i, i)]).collect();
        // Rows of a Cholesky factor, the least changed first: entries of soft springs keep their digits beside stiff ones.
        let mut left = Mat::from_fn(size, size, |i, j| -0.5 * (self.by_motion[(i, j)] + self.by_motion[(j, i)]));
        let length = |i: usize| if i % 6 < 3 { 1.0 } else { self.length };
        let part = |left: &Mat<f64>, i: usize| if own[i] > 0.0 { left[(i, i)] / own[i] } else { 0.0 };
        // A stiffness beside which the turn of forces is large is none of a spring.
        let is_sound = |left: &Mat<f64>, i: usize| {
            (0..size).all(|j| {
                let [beside, of] = [left[(i, j)].abs(), left[(i, i)]];
                beside * beside <= 2.0 * of * own[j] || beside * length(i) <= of * length(j)
            })
        };
        let mut rows: Vec<Vec<f64>> = Vec::new();
        loop {
            let stiff = (0..size).filter(|i| part(&left, *i) > TAKEN && is_sound(&left, *i));
            let Some(pivot) = stiff.max_by(|a, b| part(&left, *a).total_cmp(&part(&left, *b))) else { break };
            let root = left[(pivot, pivot)].sqrt();
            let row: Vec<f64> = (0..size).map(|j| left[(pivot, j)] / root).collect();
            for (i, j) in (0..size).flat_map(|j| (0..size).map(move |i| (i, j))) {
                left[(i, j)] -= row[i] * row[j];
            }
            (0..size).for_each(|i| (left[(pivot, i)], left[(i, pivot)]) = (0.0, 0.0));
            rows.push(row);
        }
        self.by_motion = Mat::from_fn(size, size, |i, j| {
            let rest = 0.5 * (self.by_motion[(i, j)] - self.by_motion[(j, i)]) - left[(i, j)];
            if rest.abs() > LEFT * (own[i] * own[j]).abs().sqrt() { rest } else { 0.0 }
        });
        let over_all = |row: &Vec<f64>| {
            let mut whole = vec![0.0; n];
            for (k, end) in self.on_bodies() {
                for j in 0..end.tangent.motion.ncols() {
                    whole[end.first + j] += (0..6).map(|i| row[6 * k + i] * end.tangent.motion[(i, j)]).sum::<f64>();
                }
            }
            whole
        };
        rows.iter().map(over_all).collect()
    }

    /// The ends that are on bodies, with their numbers.
    fn on_bodies(&self) -> impl Iterator<Item = (usize, &TieEnd)> {
        self.ends.iter().enumerate().filter_map(|(k, end)| Some((k, end.as_ref()?)))
    }

    /// Adds its generalised forces to those of all coordinates.
    pub fn add_forces(&self, forces: &mut [f64]) {
        for (k, end) in self.on_bodies() {
            let motion = &end.tangent.motion;
            let [force, moment] = &self.wrenches[k];
            for j in 0..motion.ncols() {
                let work: f64 = (0..3).map(|i| motion[(i, j)] * force[i] + motion[(3 + i, j)] * moment[i]).sum();
                forces[end.first + j] += work;
            }
        }
    }

    /// Adds its generalised forces and their changes to the sums over all coordinates.
    pub fn add_to(&self, sums: &mut Sums<'_>) {
        self.add_forces(sums.forces);
        for (k, end) in self.on_bodies() {
            let motion = &end.tangent.motion;
            let n = motion.ncols();
            let [force, moment] = &self.wrenches[k];
            let mut own = Mat::zeros(n, n);
            end.tangent.add_force_change([force, moment], &mut own);
            sums.by_place.add([end.first; 2], 1.0, &own);
            for (l, other) in self.on_bodies() {
                let block = |matrix: &Mat<f64>| motion.transpose() * matrix.get(6 * k..6 * k + 6, 6 * l..6 * l + 6);
                let (by_motion, by_velocity) = (block(&self.by_motion), block(&self.by_velocity));
                let by_place = by_motion * &other.tangent.motion + &by_velocity * &other.tangent.velocity;
                sums.by_place.add([end.first, other.first], 1.0, &by_place);
                sums.by_velocity.add([end.first, other.first], 1.0, &(by_velocity * &other.tangent.motion));
            }
        }
    }

    /// Adds the stiffness of its own law, without what its forces do where bodies turn and bend.
    pub fn add_law(&self, stiffness: &mut Blocks) {
        for ((k, end), (l, other)) in self.on_bodies().flat_map(|one| self.on_bodies().map(move |other| (one, other))) {
            let by_motion = self.by_motion.get(6 * k..6 * k + 6, 6 * l..6 * l + 6);
            let block = end.tangent.motion.transpose() * by_motion * &other.tangent.motion;
            stiffness.add([end.first, other.first], -1.0, &block);
        }
    }

    /// Adds what its forces do to each body.
    pub fn add_borne(&self, borne: &mut [Borne]) {
        for (k, end) in self.on_bodies() {
            let [force, moment] = &self.wrenches[k];
            let of = &mut borne[end.body];
            end.tangent.add_stiffening([force, moment], &mut of.stiffening);
            (of.force, of.moment) = (of.force.max(force.norm()), of.moment.max(moment.norm()));
        }
    }

    /// Displacements and turns of the markers by changes of place of all bodies, real or imaginary parts.
    pub fn motions(&self, changes: &[f64]) -> Vec<f64> {
        let mut motions = vec![0.0; 6 * self.ends.len()];
        for (k, end) in self.ends.iter().enumerate() {
            let Some(TieEnd { first, tangent, .. }) = end else { continue };
            for j in 0..tangent.motion.ncols() {
                (0..6).for_each(|i| motions[6 * k + i] += tangent.motion[(i, j)] * changes[first + j]);
            }
        }
        motions
    }

    /// Force and moment on a marker, by its number.
    pub fn wrench(&self, marker: usize) -> [Vector3<f64>; 2] {
        self.wrenches[marker]
    }

    /// Their changes by changes of place of all bodies, at the same velocities and multipliers.
    pub fn wrench_change(&self, marker: usize, changes: &[f64]) -> [Vector3<f64>; 2] {
        let z = self.motions(changes);
        let row = |i: usize| z.iter().enumerate().map(|(j, z)| self.by_motion[(6 * marker + i, j)] * z).sum::<f64>();
        [Vector3::from_fn(|i, _| row(i)), Vector3::from_fn(|i, _| row(3 + i))]
    }

    /// True if its springs resist a motion of all bodies: a wrench on one of them then changes otherwise than by turning with its marker.
    pub fn resists(&self, velocities: &[f64]) -> bool {
        let z = self.motions(velocities);
        let [mut most, mut largest] = [0.0_f64; 2];
        for (k, _) in self.on_bodies() {
            let turn = Vector3::from_fn(|i, _| z[6 * k + 3 + i]);
            let turned = self.wrenches[k].map(|wrench| turn.cross(&wrench));
            for i in 0..6 {
                let parts = || z.iter().enumerate().map(|(j, z)| self.by_motion[(6 * k + i, j)] * z);
                let with_marker = turned[i / 3][i % 3];
                most = most.max((parts().sum::<f64>() - with_marker).abs());
                largest = largest.max(parts().map(f64::abs).sum::<f64>() + with_marker.abs());
            }
        }
        most > ROUNDING * largest
    }

    /// Twice the energy that small changes of place put into it: −zᵀ (change of the wrenches by z), z the motions of the markers.
    pub fn twice_energy(&self, changes: &[f64]) -> f64 {
        let z = self.motions(changes);
        -(0..z.len()).map(|j| (0..z.len()).map(|i| z[i] * self.by_motion[(i, j)] * z[j]).sum::<f64>()).sum::<f64>()
    }
}

fn list(on_both: [[Vector3<f64>; 2]; 2]) -> [f64; 12] {
    std::array::from_fn(|k| on_both[k / 6][k % 6 / 3][k % 3])
}

/// Λ_k of the modes of a body.
pub(crate) fn stiffnesses(body: &ConservativeBody) -> impl Iterator<Item = f64> {
    body.circular_frequencies.iter().map(|omega| omega * omega)
}
