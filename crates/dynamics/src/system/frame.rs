//! The frame in which steps are taken: it stands at the centre of mass of the start and, where nothing ties the system to the ground, moves with it.
//!
//! ```text
//! r_b − c(t),  P_b − m_b U,  h_b = (r_b − c)×(P_b − m_b U) + A_bᵀ π_b        c(t) = c₀ + U (t − t₀)
//! ```
//!
//! Of momenta about a place that is far away, or of a body that flies fast past it, π would be a small difference of large numbers, and of the errors
//! of places times their momenta. Eq. (J2) of `docs/method/systems.md`.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::conservative::{ConservativeBody, get, part};
use crate::state::State;
use crate::system::description::System;

/// A place that moves steadily.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Frame {
    time: f64,
    center: [f64; 3],
    velocity: [f64; 3],
}

impl Frame {
    /// The global frame.
    pub const GLOBAL: Self = Self { time: 0.0, center: [0.0; 3], velocity: [0.0; 3] };

    /// The frame of bodies in some states at a time.
    pub fn of(system: &System, states: &[State], time: f64) -> Self {
        let (mut mass, mut moment, mut momentum) = (0.0, Vector3::zeros(), Vector3::zeros());
        for (body, state) in system.bodies.iter().zip(states) {
            let slow = body.list(state);
            mass += body.mass();
            moment += get(slow.slow(), part::POSITION) * body.mass();
            momentum += get(slow.slow(), part::MOMENTUM);
        }
        let on_ground = system.connections.markers().any(|marker| marker.body().is_none());
        let flies = !on_ground && system.bodies.iter().all(ConservativeBody::is_free);
        let velocity = if flies { momentum / mass } else { Vector3::zeros() };
        let found = Self { time, center: (moment / mass).into(), velocity: velocity.into() };
        if found.numbers().all(f64::is_finite) { found } else { Self::GLOBAL }
    }

    /// Its velocity.
    pub fn velocity(&self) -> Vector3<f64> {
        self.velocity.into()
    }

    /// Its place at a time.
    pub fn center_at(&self, time: f64) -> Vector3<f64> {
        Vector3::from(self.center) + self.velocity() * (time - self.time)
    }

    /// All its numbers.
    pub fn numbers(&self) -> impl Iterator<Item = f64> {
        [self.time].into_iter().chain(self.center).chain(self.velocity)
    }
}
