//! Where the bodies of a system are, and how they move, where its equations are made linear.

use nalgebra::{Matrix3, Vector3};
use rigid_kin::Attitude;

use crate::conservative::ConservativeBody;
use crate::conservative::frame::Frame;
use crate::conservative::manifold::BentShape;
use crate::conservative::{get, part};
use crate::state::State;
use crate::system::description::System;
use crate::system::marker::{BodyPlace, Marker, MarkerPlace};
use crate::system::radau::SystemMotion;
use crate::system::stage::vector;

/// The bodies of a system at one time; modes do not move.
#[derive(Debug, Clone)]
pub(crate) struct Configuration {
    pub time: f64,
    pub bodies: Vec<BodyConfiguration>,
    /// Turns of the joints.
    pub turns: Vec<f64>,
}

/// One body.
#[derive(Debug, Clone)]
pub(crate) struct BodyConfiguration {
    /// In the frame of the body.
    pub origin: Vector3<f64>,
    frame: Frame,
    /// Velocity from which the velocities of the body are counted, global.
    pub carried: Vector3<f64>,
    pub attitude: Attitude,
    pub body_from_global: Matrix3<f64>,
    pub q: Vec<f64>,
    /// Its shape with large modes.
    pub bent: Option<BentShape>,
    /// V and ω in body axes, V beside `carried`.
    pub velocity: Vector3<f64>,
    pub omega: Vector3<f64>,
    /// Angular momentum of a rotor about its axis, in axes that do not turn with it; zero of any other body.
    pub own_momentum: Vector3<f64>,
    /// V' and ω', the rates of their components; zero in a steady spin.
    pub velocity_rate: Vector3<f64>,
    pub omega_rate: Vector3<f64>,
}

impl BodyConfiguration {
    /// Where a body is in a state, at rest.
    pub fn still(body: &ConservativeBody, state: &State) -> Self {
        let list = body.list(state);
        Self {
            bent: BentShape::of(body, list.q()),
            origin: get(list.slow(), part::POSITION),
            frame: body.frame,
            carried: Vector3::zeros(),
            attitude: list.attitude(),
            body_from_global: list.attitude().global_to_body(),
            q: list.q().to_vec(),
            velocity: Vector3::zeros(),
            omega: Vector3::zeros(),
            own_momentum: Vector3::zeros(),
            velocity_rate: Vector3::zeros(),
            omega_rate: Vector3::zeros(),
        }
    }
}

/// A turn about an axis that does not move, at a steady speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CommonSpin {
    /// Angular velocity, global.
    pub omega_global: Vector3<f64>,
    /// A point of the axis.
    pub point_global: Vector3<f64>,
}

impl CommonSpin {
    /// Rest.
    pub const REST: Self =
        Self { omega_global: Vector3::new(0.0, 0.0, 0.0), point_global: Vector3::new(0.0, 0.0, 0.0) };

    /// Velocity of the origin of a body that turns with it, global.
    pub(crate) fn velocity_at(&self, body: &BodyConfiguration, time: f64) -> Vector3<f64> {
        let arm = body.origin - body.frame.place_from(&self.point_global, time);
        self.omega_global.cross(&arm)
    }
}

impl Configuration {
    /// Where a motion is, in a common spin.
    pub fn of(motion: &SystemMotion, spin: &CommonSpin) -> Self {
        let mut configuration = Self::still(motion);
        configuration.spin(spin);
        configuration
    }

    /// Where a motion is, with these velocities and their rates over the coordinates of all bodies, of which the modal ones do not count.
    pub fn moving(motion: &SystemMotion, [velocities, rates]: [&[f64]; 2]) -> Self {
        let mut configuration = Self::still(motion);
        for (body, first) in configuration.bodies.iter_mut().zip(&motion.system().first) {
            [body.velocity, body.omega] = [0, 3].map(|part| vector(velocities, first + part));
            [body.velocity_rate, body.omega_rate] = [0, 3].map(|part| vector(rates, first + part));
            body.carried = body.frame.velocity();
        }
        configuration
    }

    /// Adds to the rates of the velocities, over the coordinates of all bodies, of which the modal ones do not count.
    pub fn accelerate(&mut self, system: &System, rates: &[f64]) {
        for (body, first) in self.bodies.iter_mut().zip(&system.first) {
            body.velocity_rate += vector(rates, *first);
            let mut omega_rate = vector(rates, first + 3);
            // The axes of a rotor do not turn with it.
            if let Some(axis) = body.own_momentum.try_normalize(0.0) {
                omega_rate -= axis * axis.dot(&omega_rate);
            }
            body.omega_rate += omega_rate;
        }
    }

    fn still(motion: &SystemMotion) -> Self {
        let system = motion.system();
        let bodies = system.bodies.iter().zip(&motion.bodies);
        Self {
            time: motion.time(),
            bodies: bodies.map(|(body, state)| BodyConfiguration::still(body, state)).collect(),
            turns: (0..system.joints().len()).map(|joint| motion.joint_coordinates(joint).turn).collect(),
        }
    }

    /// Gives the bodies the velocities of a common spin.
    fn spin(&mut self, spin: &CommonSpin) {
        for body in &mut self.bodies {
            body.velocity = body.body_from_global * spin.velocity_at(body, self.time);
            body.omega = body.body_from_global * spin.omega_global;
        }
    }

    /// Moves the bodies by ρ and φ in body axes, and δq, and gives them the velocities of a common spin, if there is one.
    pub fn change(&mut self, system: &System, by: &[f64], spin: Option<&CommonSpin>) {
        for (body, first) in self.bodies.iter_mut().zip(&system.first) {
            let [moved, turned] = [0, 3].map(|part| vector(by, first + part));
            body.origin += body.body_from_global.tr_mul(&moved);
            body.attitude = body.attitude.advanced_by(&turned);
            body.body_from_global = body.attitude.global_to_body();
            body.q.iter_mut().zip(&by[first + 6..]).for_each(|(q, change)| *q += change);
            if let Some(bent) = &mut body.bent {
                bent.go(&body.q);
            }
        }
        if let Some(spin) = spin {
            self.spin(spin);
        }
    }

    /// The place of the origin of a body, and the velocity, global.
    pub fn origin_global(&self, body: &BodyConfiguration) -> [Vector3<f64>; 2] {
        let velocity = body.body_from_global.tr_mul(&body.velocity) + body.carried;
        [body.frame.global_place(&body.origin, self.time), velocity]
    }

    /// A place next to the first of some markers, global.
    pub fn global_by(&self, markers: &[Marker; 2], place: &Vector3<f64>) -> Vector3<f64> {
        let frame = markers.iter().find_map(|marker| Some(self.bodies[marker.body()?].frame));
        frame.map_or(*place, |frame| frame.global_place(place, self.time))
    }

    /// The place of a body.
    pub fn place(&self, body: usize) -> BodyPlace<'_> {
        let BodyConfiguration { origin, body_from_global, q, bent, .. } = &self.bodies[body];
        let bent = bent.as_ref().map(BentShape::place);
        BodyPlace { origin: *origin, body_from_global: *body_from_global, q, bent }
    }

    /// Where the two markers of a joint, or of a part of it, are.
    pub fn places(&self, markers: &[Marker; 2]) -> [MarkerPlace; 2] {
        markers.each_ref().map(|marker| marker.place(marker.body().map(|b| self.place(b)).as_ref()))
    }
}
