//! The bodies and rows of a system at one time within a step.

use nalgebra::{Matrix3, Vector3};
use rigid_kin::{f_inverse, transformation_matrix};

use crate::conservative::Evaluation;
use crate::conservative::{ConservativeBody, Slow, get, part, set};
use crate::equations::Equations;
use crate::error::RateError;
use crate::matrix::lists::larger;
use crate::state::State;
use crate::system::constraints::{Compliant, Constraints, near};
use crate::system::description::System;
use crate::system::element::Stored;
use crate::system::elimination::inverse::Inertia;
use crate::system::geometry::posture::Posture;
use crate::system::joint::coordinate::{Coordinate, JointCoordinates, turn_along};
use crate::system::joint::far::far_wrench;
use crate::system::joint::force::{Forces, FrictionSlope};
use crate::system::joint::work::JointWork;
use crate::system::marker::motion::{MarkerMotion, MarkerWrench};
use crate::system::marker::{BodyPlace, Marker, MarkerPlace, tangent_of};

/// The start of a step: the numbers that its increments are counted from.
#[derive(Debug, Clone)]
pub(crate) struct Start {
    pub time: f64,
    pub bodies: Vec<BodyStart>,
    /// q and p of all bodies, at the places of their coordinates.
    pub q: Vec<f64>,
    pub p: Vec<f64>,
    /// Coordinates of the joints.
    pub joints: Vec<JointCoordinates>,
}

impl Start {
    /// The turn of a joint that is expected where its markers are, with increments of the bodies since the start of the step.
    fn turn(&self, system: &System, joint: usize, places: [&MarkerPlace; 2], increments: &[f64]) -> f64 {
        let [i, j] = system.connections.joints[joint].markers.each_ref().map(|marker| {
            let path = |b: usize| self.bodies[b].body_from_global.tr_mul(&vector(increments, system.first[b] + 3));
            marker.body().map_or_else(Vector3::zeros, path)
        });
        turn_along(places, [&i, &j], self.joints[joint].turn)
    }
}

/// The start of one body.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BodyStart {
    /// Position of the origin in the frame, and from where angular momentum is counted: the centre of the frame, or its own.
    pub position: Vector3<f64>,
    pub arm: Vector3<f64>,
    pub spins_apart: bool,
    pub body_from_global: Matrix3<f64>,
    /// Linear momentum in the frame, and angular momentum, global.
    pub momentum: Vector3<f64>,
    pub angular_momentum: Vector3<f64>,
}

impl BodyStart {
    /// A body with its angular momentum about the centre of its frame, or about its own origin.
    pub fn new(body: &ConservativeBody, state: &State, spins_apart: bool) -> Self {
        let list = body.list(state);
        let [position, momentum, pi] = [part::POSITION, part::MOMENTUM, part::PI].map(|part| get(list.slow(), part));
        let body_from_global = list.attitude().global_to_body();
        let arm = if spins_apart { Vector3::zeros() } else { position - body.frame.center() };
        let angular_momentum = arm.cross(&momentum) + body_from_global.tr_mul(&pi);
        Self { position, arm, spins_apart, body_from_global, momentum, angular_momentum }
    }

    /// The arm of its origin where it has moved.
    fn arm(&self, moved: Vector3<f64>) -> Vector3<f64> {
        if self.spins_apart { self.arm } else { self.arm + moved }
    }
}

/// A time within a step, with increments since its start.
#[derive(Debug, Clone)]
pub(crate) struct Stage {
    /// Δr in the frame (global), the rotation vector (body axes), Δq: of each body.
    pub x: Vec<f64>,
    /// ΔP, Δh about the centre of the frame or about the body's own origin (global), Δp.
    pub y: Vec<f64>,
    pub evaluations: Vec<Evaluation>,
    pub constraints: Constraints,
    /// G v + g_t (m).
    pub constraint_rates: Vec<f64>,
    /// V in the frame and ω in body axes, and q̇, of each body.
    pub velocities: Vec<f64>,
    /// x' and y' by the forces beside those of the joints.
    pub x_rates: Vec<f64>,
    pub y_rates: Vec<f64>,
    pub inertia: Vec<Inertia>,
    /// Transformation matrices of the bodies and positions of their origins in the frame.
    pub attitudes: Vec<Matrix3<f64>>,
    pub positions: Vec<Vector3<f64>>,
    /// Positions from where angular momentum is counted.
    pub arms: Vec<Vector3<f64>>,
    /// q of all bodies.
    q: Vec<f64>,
    forces: Vec<f64>,
    scratch: Vec<f64>,
    /// Generalised forces of the elements and of joints along their coordinates, in the axes and about the origins of the bodies.
    pub element_forces: Vec<f64>,
    /// Powers of the forces of joints.
    pub joint_powers: Vec<Forces>,
    /// Powers of the force elements.
    pub element_powers: Vec<JointWork>,
    marker_places: Vec<MarkerPlace>,
    marker_motions: Vec<MarkerMotion>,
    wrenches: Vec<MarkerWrench>,
    /// Largest distance of a marker from the origin of its body.
    longest_arm: f64,
}

impl Stage {
    pub fn new(system: &System) -> Self {
        let (coordinates, rows) = (system.coordinates(), system.rows());
        let zeros = || vec![0.0; coordinates];
        let constraints = Constraints::new(&system.connections, &system.first);
        let max_markers = system.connections.elements.iter().map(|element| element.markers().len()).max().unwrap_or(0);
        Self {
            x: zeros(),
            y: zeros(),
            evaluations: system.bodies.iter().map(Equations::evaluation).collect(),
            joint_powers: vec![Forces::default(); constraints.coordinates.len()],
            constraints,
            constraint_rates: vec![0.0; rows],
            velocities: zeros(),
            x_rates: zeros(),
            y_rates: zeros(),
            inertia: system.bodies.iter().map(Inertia::of).collect(),
            attitudes: vec![Matrix3::identity(); system.bodies.len()],
            positions: vec![Vector3::zeros(); system.bodies.len()],
            arms: vec![Vector3::zeros(); system.bodies.len()],
            q: zeros(),
            forces: zeros(),
            scratch: zeros(),
            element_forces: zeros(),
            element_powers: vec![JointWork::default(); system.connections.elements.len()],
            marker_places: Vec::with_capacity(max_markers),
            marker_motions: Vec::with_capacity(max_markers),
            wrenches: Vec::with_capacity(max_markers),
            longest_arm: system.longest_arm(),
        }
    }

    /// Finds where the bodies are.
    pub fn place(&mut self, system: &System, start: &Start) {
        for (b, (body, of)) in start.bodies.iter().zip(&system.bodies).enumerate() {
            let first = system.first[b];
            let theta = vector(&self.x, first + 3);
            self.attitudes[b] = transformation_matrix(&theta) * body.body_from_global;
            let moved = vector(&self.x, first);
            (self.positions[b], self.arms[b]) = (body.position + moved, body.arm(moved));
            for k in first + 6..system.first[b + 1] {
                self.q[k] = start.q[k] + self.x[k];
            }
            of.bend(&self.q[first + 6..system.first[b + 1]], &mut self.evaluations[b]);
        }
    }

    /// Finds g and G where the bodies have been placed, at a time by the branch of another.
    pub fn find_constraints(&mut self, system: &System, start: &Start, times: [f64; 2]) {
        let Self { x, constraints, positions, attitudes, q, evaluations, .. } = self;
        let expected_turn = |joint: usize, places: [&MarkerPlace; 2]| start.turn(system, joint, places, x);
        let places = Places { system, positions, attitudes, q, evaluations };
        constraints.find(&system.connections, near, expected_turn, times, |b| places.of(b));
    }

    /// The same of markers that may be turned far against each other, with these turns of joints, which go on.
    pub fn find_far_constraints(&mut self, system: &System, turns: &mut [f64], times: [f64; 2]) {
        for (joint, turn) in turns.iter_mut().enumerate() {
            *turn = self.turn_of(system, joint, *turn);
        }
        let Self { constraints, positions, attitudes, q, evaluations, .. } = self;
        let places = Places { system, positions, attitudes, q, evaluations };
        constraints.find(&system.connections, far_wrench, |joint, _| turns[joint], times, |b| places.of(b));
    }

    /// Where its bodies and joints are, once it has its rows.
    pub fn posture(&self, system: &System) -> Posture<'_> {
        let Self { positions, attitudes, constraints, .. } = self;
        let points = system.connections.joints.iter().map(|joint| self.places(system, &joint.markers)[1].position);
        Posture::new(system, positions.iter().copied(), points, attitudes, &constraints.ends)
    }

    /// Where the two markers of a joint, or of a part of it, are.
    pub fn places(&self, system: &System, markers: &[Marker; 2]) -> [MarkerPlace; 2] {
        markers.each_ref().map(|of| of.place(of.body().map(|b| self.body_place(system, b)).as_ref()))
    }

    /// The turn of a joint next to what is expected of it.
    fn turn_of(&self, system: &System, joint: usize, expected_turn: f64) -> f64 {
        let places = self.places(system, &system.connections.joints[joint].markers);
        Coordinate::Turn.wrench(places.each_ref(), expected_turn).residual
    }

    /// Finds velocities, rates, g and G at a time; laws with branches are taken as they are at the branch time.
    pub fn evaluate(&mut self, system: &System, start: &Start, times: [f64; 2]) -> Result<(), RateError> {
        self.place(system, start);
        self.hold_points(system, start);
        for (b, (body, from)) in system.bodies.iter().zip(&start.bodies).enumerate() {
            let (first, end) = (system.first[b], system.first[b + 1]);
            let e = &mut self.evaluations[b];
            let (arm, attitude) = (self.arms[b], self.attitudes[b]);
            let momentum = from.momentum + vector(&self.y, first);
            let angular_momentum = from.angular_momentum + vector(&self.y, first + 3);
            let pi = attitude * (angular_momentum - arm.cross(&momentum));
            let mut slow = *e.at.slow();
            set(&mut slow, part::THETA, &vector(&self.x, first + 3));
            set(&mut slow, part::POSITION, &self.positions[b]);
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
            put(&mut self.velocities, first, &(attitude * get(rates, part::POSITION)));
            put(&mut self.velocities, first + 3, &e.omega_body);
            self.velocities[first + 6..end].copy_from_slice(&e.modal_velocity);
            let force = get(rates, part::MOMENTUM);
            let moment = get(rates, part::PI) - pi.cross(&e.omega_body);
            put(&mut self.y_rates, first, &force);
            put(&mut self.y_rates, first + 3, &(arm.cross(&force) + attitude.tr_mul(&moment)));
            for k in 0..end - first - 6 {
                self.y_rates[first + 6 + k] = e.rates.p()[k] + body.linear_rate(k, e.at.q()[k], e.at.p()[k]);
            }
            let inertia = &mut self.inertia[b];
            inertia.mass = body.mass();
            inertia.locked = e.locked_inertia;
            inertia.locked_inverse = match body.is_point() {
                true => Matrix3::zeros(),
                false => e.locked_inertia.try_inverse().ok_or(RateError::Inertia)?,
            };
            body.copy_coupling(e, &mut inertia.coupling);
            if let (Some(bent), Some(manifold)) = (&mut inertia.bent, &body.manifold) {
                manifold.find_bent_terms(&e.place, &mut bent.terms);
                bent.solve_coupling(&inertia.coupling);
            }
        }
        self.find_constraints(system, start, times);
        self.add_elements(system, times);
        if let Some(body) = self.turned_point(system) {
            return Err(RateError::PointTurned { body: system.named(body) });
        }
        self.constraints.rates(&self.velocities, &mut self.constraint_rates);
        Ok(())
    }

    /// Takes the spin from point masses where they have been placed. False where there are none.
    pub fn hold_points(&mut self, system: &System, start: &Start) -> bool {
        let mut found = false;
        for (b, _) in system.bodies.iter().enumerate().filter(|(_, body)| body.is_point()) {
            let first = system.first[b];
            let momentum = start.bodies[b].momentum + vector(&self.y, first);
            put(&mut self.y, first + 3, &(self.arms[b].cross(&momentum) - start.bodies[b].angular_momentum));
            found = true;
        }
        found
    }

    /// A point mass on which loads or elements put a moment, beyond the rounding of a place.
    fn turned_point(&self, system: &System) -> Option<usize> {
        let is_turned = |b: usize| {
            let first = system.first[b];
            let [force, moment] = [0, 3].map(|part| vector(&self.y_rates, first + part));
            let arm = self.arms[b];
            let own = moment - arm.cross(&force);
            own.norm() > OF_PLACES * force.norm() * arm.norm().max(self.longest_arm)
        };
        (0..system.bodies.len()).find(|b| system.bodies[*b].is_point() && is_turned(*b))
    }

    /// Kinetic and strain energy in the frame, and that which the forces give bodies at rest within a time if no joint holds them.
    pub fn energies(&mut self, system: &System, time: f64) -> [f64; 2] {
        let (mut moving, mut pushed) = (0.0, 0.0);
        for (b, body) in system.bodies.iter().enumerate() {
            let own = system.first[b]..system.first[b + 1];
            let momenta = &mut self.forces;
            momenta[own.clone()].copy_from_slice(&self.velocities[own.clone()]);
            self.inertia[b].multiply(&mut momenta[own.clone()]);
            let pairs = self.velocities[own.clone()].iter().zip(&momenta[own.clone()]);
            moving += 0.5 * pairs.map(|(v, p)| v * p).sum::<f64>();
            let strained = self.q[own.start + 6..own.end].iter().zip(&body.circular_frequencies);
            moving += 0.5 * strained.map(|(q, omega)| (omega * q).powi(2)).sum::<f64>();
            let [force, impulse] = [&mut self.scratch, &mut self.forces];
            for list in [&mut *force, &mut *impulse] {
                list[own.clone()].copy_from_slice(&self.y_rates[own.clone()]);
                about_body_origin(&mut list[own.clone()], &self.arms[b], &self.attitudes[b]);
            }
            self.inertia[b].solve(&mut impulse[own.clone()]);
            let power = impulse[own.clone()].iter().zip(&force[own]).map(|(v, f)| v * f).sum::<f64>();
            pushed += 0.5 * time * time * power;
        }
        [moving, pushed]
    }

    /// Turns changes of x and y to the axes and origins of the bodies.
    pub fn to_body_axes(&self, system: &System, x: &mut [f64], y: &mut [f64]) {
        for (b, (arm, attitude)) in self.arms.iter().zip(&self.attitudes).enumerate() {
            let first = system.first[b];
            let moved = attitude * vector(x, first);
            put(x, first, &moved);
            about_body_origin(&mut y[first..first + 6], arm, attitude);
        }
    }

    /// The inverse of [`Self::to_body_axes`].
    pub fn to_global_axes(&self, system: &System, x: &mut [f64], y: &mut [f64]) {
        for (b, (arm, attitude)) in self.arms.iter().zip(&self.attitudes).enumerate() {
            let first = system.first[b];
            let moved = attitude.tr_mul(&vector(x, first));
            put(x, first, &moved);
            about_center(&mut y[first..first + 6], arm, attitude);
        }
    }

    /// Adds changes in the axes and about the origins of the bodies to x and y.
    pub fn add_in_body_axes(&mut self, system: &System, dx: &mut [f64], dy: &mut [f64]) {
        self.to_global_axes(system, dx, dy);
        self.x.iter_mut().zip(dx).for_each(|(x, change)| *x += *change);
        self.y.iter_mut().zip(dy).for_each(|(y, change)| *y += *change);
    }

    /// The place of a body.
    pub fn body_place<'a>(&'a self, system: &'a System, b: usize) -> BodyPlace<'a> {
        let Self { positions, attitudes, q, evaluations, .. } = self;
        Places { system, positions, attitudes, q, evaluations }.of(b)
    }

    /// The coordinates of a joint, where the bodies have been placed and move with the velocities; the turn goes on from
    /// the start of the step.
    pub fn joint_coordinates(&self, system: &System, start: &Start, joint: usize) -> JointCoordinates {
        let markers = &system.connections.joints[joint].markers;
        let place = |k: usize| markers[k].place(markers[k].body().map(|b| self.body_place(system, b)).as_ref());
        let places = [place(0), place(1)];
        let motions = [0, 1].map(|k: usize| self.motion_of(system, &markers[k], &places[k]));
        let expected_turn = start.turn(system, joint, places.each_ref(), &self.x);
        let [turn, slide] = [Coordinate::Turn, Coordinate::Slide]
            .map(|coordinate| coordinate.wrench(places.each_ref(), expected_turn))
            .map(|wrench| [wrench.residual, wrench.rate(motions.each_ref())]);
        JointCoordinates { turn: turn[0], turn_rate: turn[1], slide: slide[0], slide_rate: slide[1] }
    }

    /// The motion of a marker at its place.
    pub fn motion_of(&self, system: &System, marker: &Marker, place: &MarkerPlace) -> MarkerMotion {
        let body = marker.body().map(|b| self.body_place(system, b));
        let velocities = marker.body().map_or(&[][..], |b| &self.velocities[system.first[b]..system.first[b + 1]]);
        marker.motion(place, body.as_ref(), velocities)
    }

    /// Adds the forces of joints along their coordinates to those of the elements.
    fn add_joint_forces(&mut self, system: &System, times: [f64; 2]) {
        let Self { constraints, element_forces, velocities, joint_powers, .. } = self;
        let rows = constraints.compliant_ends().iter().zip(&constraints.coordinates).zip(joint_powers);
        for ((_, _, law), ((ends, coordinate), powers)) in system.connections.joint_forces().zip(rows) {
            let mut rate = 0.0;
            ends.iter().for_each(|end| end.add_rate(1.0, velocities, &mut rate));
            let forces = law.at([*coordinate, rate], times);
            *powers = forces.times(rate);
            ends.iter().for_each(|end| end.add_force(forces.sum(), element_forces));
        }
    }

    /// Takes the motion to where increments at three stages lead by these factors, and gives it the rates that they have there by those.
    pub fn follow(&mut self, (system, start): (&System, &Start), increments: [&[f64]; 3], [to, rates]: [[f64; 3]; 2]) {
        let [a, b, c] = increments;
        let of = |factors: [f64; 3], k: usize| factors[0] * a[k] + factors[1] * b[k] + factors[2] * c[k];
        (0..self.x.len()).for_each(|k| self.x[k] = of(to, k));
        self.place(system, start);
        (0..self.velocities.len()).for_each(|k| self.velocities[k] = of(rates, k));
        for (attitude, first) in self.attitudes.iter().zip(&system.first) {
            let velocity = attitude * vector(&self.velocities, *first);
            // ω = T(θ)ᵀ θ', the inverse of `f_inverse`.
            let omega = tangent_of(&vector(&self.x, first + 3)).tr_mul(&vector(&self.velocities, first + 3));
            put(&mut self.velocities, *first, &velocity);
            put(&mut self.velocities, first + 3, &omega);
        }
    }

    /// Finds the powers of the forces of joints and of elements that have work which only sums tell, where the bodies have been placed and
    /// move with the velocities.
    pub fn find_powers(&mut self, system: &System, start: &Start, times: [f64; 2]) {
        for (number, (joint, coordinate, force)) in system.connections.joint_forces().enumerate() {
            if force.has_work() {
                let at = self.joint_coordinates(system, start, joint).along(coordinate);
                self.constraints.coordinates[number] = at[0];
                self.joint_powers[number] = force.at(at, times).times(at[1]);
            }
        }
        for number in 0..system.connections.elements.len() {
            self.find_marker_motions(system, number, times[0]);
            self.apply_element(system, number, times);
        }
    }

    /// Finds the functions that change their signs at kinks of the forces of joints and of elements, in the order of these; an error where
    /// one is not a number.
    pub fn find_switches(
        &mut self,
        system: &System,
        start: &Start,
        times: [f64; 2],
        out: &mut Vec<f64>,
    ) -> Result<(), RateError> {
        out.clear();
        let extend = |out: &mut Vec<f64>, switch: f64, law: &dyn Fn() -> String| {
            if switch.is_nan() {
                return Err(RateError::Switch { law: law().into() });
            }
            out.push(switch);
            Ok(())
        };
        for (joint, coordinate, force) in system.connections.joint_forces() {
            if force.stops.is_some() || !force.laws.is_empty() {
                let name = || format!("a law at the joint \"{}\"", system.connections.joints[joint].name);
                let at = self.joint_coordinates(system, start, joint).along(coordinate);
                force.switches(at, times).try_for_each(|switch| extend(out, switch, &name))?;
            }
        }
        for (number, element) in system.connections.elements.iter().enumerate() {
            self.find_marker_motions(system, number, times[0]);
            if let Some(switch) = element.switch(times, &self.marker_motions) {
                extend(out, switch, &|| format!("the force element {} of the system", number + 1))?;
            }
        }
        Ok(())
    }

    /// Finds the wrenches of an element and their power, where the motions of its markers have been found.
    fn apply_element(&mut self, system: &System, number: usize, times: [f64; 2]) {
        let element = &system.connections.elements[number];
        let Self { marker_motions, wrenches, element_powers, .. } = self;
        wrenches.clear();
        wrenches.resize(marker_motions.len(), MarkerWrench::default());
        element.apply(times, marker_motions, wrenches);
        let of_marker = |(MarkerWrench { force_global, moment_global }, motion): (&MarkerWrench, &MarkerMotion)| {
            force_global.dot(&motion.velocity_global) + moment_global.dot(&motion.omega_global)
        };
        let power: f64 = wrenches.iter().zip(&*marker_motions).map(of_marker).sum();
        element_powers[number] = match element.stored(marker_motions) {
            Some(Stored { damping_power: loss, .. }) => JointWork { drive: 0.0, spring: power + loss, loss },
            None => JointWork { drive: power, ..JointWork::default() },
        };
    }

    /// Adds the forces of the elements and of joints along their coordinates to y'.
    fn add_elements(&mut self, system: &System, times: [f64; 2]) {
        if system.connections.elements.is_empty() && self.joint_powers.is_empty() {
            return;
        }
        self.element_forces.fill(0.0);
        self.add_joint_forces(system, times);
        for (number, markers) in system.connections.element_markers.iter().enumerate() {
            self.find_marker_motions(system, number, times[0]);
            self.apply_element(system, number, times);
            let Self { marker_places, wrenches, element_forces: forces, positions, attitudes, q, evaluations, .. } =
                self;
            let places = Places { system, positions, attitudes, q, evaluations };
            for (k, MarkerWrench { force_global, moment_global }) in wrenches.iter().enumerate() {
                if let Some(b) = markers[k].body() {
                    markers[k].add_wrench(
                        &marker_places[k],
                        &places.of(b),
                        [force_global, moment_global],
                        &mut forces[system.first[b]..system.first[b + 1]],
                    );
                }
            }
        }
        let Self { element_forces: forces, forces: total, arms, attitudes, .. } = self;
        total.copy_from_slice(forces);
        for (b, (arm, attitude)) in arms.iter().zip(&*attitudes).enumerate() {
            let first = system.first[b];
            about_center(&mut total[first..first + 6], arm, attitude);
        }
        self.y_rates.iter_mut().zip(&*total).for_each(|(rate, force)| *rate += force);
    }

    /// Energy of the springs of an element at a time, where the bodies have been placed; zero where it is not known.
    pub fn element_energy(&mut self, system: &System, number: usize, time: f64) -> f64 {
        let element = &system.connections.elements[number];
        self.find_marker_motions(system, number, time);
        element.stored(&self.marker_motions).map_or(0.0, |stored| stored.energy)
    }

    /// Finds the places of the markers of an element, and their motions as it sees them.
    fn find_marker_motions(&mut self, system: &System, number: usize, time: f64) {
        let Self { marker_places, marker_motions, positions, attitudes, q, evaluations, velocities, .. } = self;
        let places = Places { system, positions, attitudes, q, evaluations };
        marker_places.clear();
        marker_motions.clear();
        for marker in &system.connections.element_markers[number] {
            let body = marker.body().map(|b| places.of(b));
            let place = marker.place(body.as_ref());
            let own = marker.body().map_or(&[][..], |b| &velocities[system.first[b]..system.first[b + 1]]);
            let motion = marker.motion(&place, body.as_ref(), own);
            marker_motions.push(system.motion_for(number, marker, motion, time));
            marker_places.push(place);
        }
    }

    /// Finds what Newton's method is to know of the forces of joints and of elements, where the stage has been evaluated. Without
    /// `of_laws`, elements and forces with laws from outside stay as they were last found: these may take long.
    pub fn linearize(&mut self, system: &System, times: [f64; 2], by: FrictionSlope, of_laws: bool) {
        let mut number = 0;
        for (_, _, force) in system.connections.joint_forces() {
            if !of_laws && !force.laws.is_empty() {
                number += 1;
                continue;
            }
            let mut rate = 0.0;
            let constraints = &mut self.constraints;
            constraints.compliant_ends()[number].iter().for_each(|end| end.add_rate(1.0, &self.velocities, &mut rate));
            let [stiffness, damping] = force.stiffness_and_damping([constraints.coordinates[number], rate], times, by);
            constraints.compliant[number] = Compliant { stiffness, damping };
            number += 1;
        }
        if !of_laws {
            return;
        }
        let elements = system.connections.elements.iter().zip(&system.connections.element_markers).enumerate();
        for (of_element, (element, markers)) in elements.filter(|(_, (element, _))| element.directions() > 0) {
            self.find_marker_motions(system, of_element, times[0]);
            let Self { marker_places, marker_motions, constraints, positions, attitudes, q, evaluations, .. } = self;
            let places = Places { system, positions, attitudes, q, evaluations };
            element.linearize(times, marker_motions, &mut |direction, [stiffness, damping], wrenches| {
                if direction < element.directions() {
                    let on_markers = markers.iter().zip(&*marker_places).zip(wrenches);
                    let on_markers = on_markers.map(|((marker, place), wrench)| (marker, place, wrench));
                    constraints.set_compliant(number + direction, Compliant { stiffness, damping }, on_markers, |b| {
                        places.of(b)
                    });
                }
            });
            number += element.directions();
        }
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
            let velocity = self.attitudes[b].tr_mul(&vector(&self.x_rates, first));
            put(&mut self.x_rates, first, &velocity);
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
            about_center(&mut self.forces[first..end], &self.arms[b], &self.attitudes[b]);
        }
        out.iter_mut().zip(self.y_rates.iter().zip(&self.forces)).for_each(|(out, (rate, force))| *out = rate + force);
    }

    /// Finds what joints with these multipliers and the elements do to the bodies, for [`Self::add_joint_exchange`].
    pub fn find_joint_forces(&mut self, multipliers: &[f64]) {
        self.forces.copy_from_slice(&self.element_forces);
        self.constraints.add_forces(multipliers, &mut self.forces);
    }

    /// Adds to the rates of a body's work and impulses what joints and elements do to it.
    pub fn add_joint_exchange(&self, system: &System, b: usize, rates: &mut Slow) {
        let own = system.first[b]..system.first[b + 1];
        let (forces, velocities) = (&self.forces[own.clone()], &self.velocities[own]);
        rates[part::WORK] += forces.iter().zip(velocities).map(|(force, velocity)| force * velocity).sum::<f64>();
        for (which, first) in [(part::IMPULSE, 0), (part::ANGULAR_IMPULSE, 3)] {
            let sum = get(rates, which) + self.attitudes[b].tr_mul(&vector(forces, first));
            set(rates, which, &sum);
        }
    }

    /// Removes the part of the velocities that the rows forbid, and the momenta that go with it, by `solve` of A λ = G v.
    /// Returns the largest rate that was left, NaN where one is no number.
    pub fn project_velocities(
        &mut self,
        system: &System,
        momenta: &mut [f64],
        mut solve: impl FnMut(&mut [f64]),
    ) -> f64 {
        let mut left = f64::INFINITY;
        for _ in 0..MAX_PROJECTIONS {
            self.constraints.rates(&self.velocities, &mut self.constraint_rates);
            let largest = self.constraint_rates.iter().fold(0.0, |most, rate| larger(most, rate.abs()));
            if largest.is_nan() {
                return largest;
            }
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

/// Where the bodies of a stage are.
#[derive(Clone, Copy)]
struct Places<'a> {
    system: &'a System,
    positions: &'a [Vector3<f64>],
    attitudes: &'a [Matrix3<f64>],
    q: &'a [f64],
    evaluations: &'a [Evaluation],
}

impl<'a> Places<'a> {
    fn of(self, b: usize) -> BodyPlace<'a> {
        let Self { system, positions, attitudes, q, evaluations } = self;
        BodyPlace {
            origin: positions[b],
            body_from_global: attitudes[b],
            q: &q[system.first[b] + 6..system.first[b + 1]],
            bent: system.bodies[b].bent_place(&evaluations[b]),
        }
    }
}

/// Arm of a force on a point mass over lengths of the system, which is rounding of places.
pub(crate) const OF_PLACES: f64 = 1e-9;

/// Passes of a projection before it is left as it is.
const MAX_PROJECTIONS: usize = 20;

/// Turns a force and a moment about the body's origin (body axes) into a force and a moment about the centre of the frame (global), from which the
/// origin is this far.
pub(crate) fn about_center(force: &mut [f64], arm: &Vector3<f64>, body_from_global: &Matrix3<f64>) {
    let [f, moment] = [0, 3].map(|first| body_from_global.tr_mul(&vector(force, first)));
    put(force, 0, &f);
    put(force, 3, &(arm.cross(&f) + moment));
}

/// The inverse of [`about_center`].
pub(crate) fn about_body_origin(force: &mut [f64], arm: &Vector3<f64>, body_from_global: &Matrix3<f64>) {
    let [f, moment] = [vector(force, 0), vector(force, 3)];
    put(force, 0, &(body_from_global * f));
    put(force, 3, &(body_from_global * (moment - arm.cross(&f))));
}

pub(crate) fn vector(list: &[f64], first: usize) -> Vector3<f64> {
    Vector3::new(list[first], list[first + 1], list[first + 2])
}

pub(crate) fn put(list: &mut [f64], first: usize, value: &Vector3<f64>) {
    list[first..first + 3].copy_from_slice(value.as_slice());
}
