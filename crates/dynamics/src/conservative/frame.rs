//! The frame of the numbers of a body: far from the global origin, or in fast flight, numbers in it have the digits that they have near the origin.
//!
//! ```text
//! r = anchor + moved + U (t − t₀) + r_frame,     V = U + V_frame
//! P = m U + P_frame,     kinetic energy = frame's + U·P_frame + ½ m U²,     work = frame's + U·impulse
//! ```

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Distances of the places that anchors are taken from, over the size of what they are near, at least.
const COARSE: f64 = 16.0;

/// A place that moves steadily without turning, and that the position and the velocity of a body are counted from.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Frame {
    anchor: [f64; 3],
    /// From the anchor to its place at `time`.
    moved: [f64; 3],
    velocity: [f64; 3],
    time: f64,
    /// The place that angular momenta of a system are about, in the frame.
    center: [f64; 3],
}

impl Frame {
    /// The global frame.
    pub const GLOBAL: Self =
        Self { anchor: [0.0; 3], moved: [0.0; 3], velocity: [0.0; 3], time: 0.0, center: [0.0; 3] };

    /// A frame at an anchor at a time, whose angular momenta are about a place. The global one where a number is not finite.
    pub fn new(anchor: Vector3<f64>, velocity: Vector3<f64>, time: f64, center_global: Vector3<f64>) -> Self {
        let center = (center_global - anchor).into();
        let found = Self { anchor: anchor.into(), moved: [0.0; 3], velocity: velocity.into(), time, center };
        if found.numbers().all(f64::is_finite) { found } else { Self::GLOBAL }
    }

    /// The place next to another of a grid so coarse, beside a size, that numbers near it are exact when they are counted from there; near the
    /// global origin that is the origin.
    pub fn anchor_near(place: &Vector3<f64>, size: f64) -> Vector3<f64> {
        if size <= 0.0 || !size.is_finite() {
            return *place;
        }
        let pitch = 2.0_f64.powi((COARSE * size).log2().ceil() as i32);
        let on_grid = place.map(|x| (x / pitch).round() * pitch);
        if on_grid.iter().all(|x| x.is_finite()) { on_grid } else { Vector3::zeros() }
    }

    /// Where it was at first.
    pub fn anchor(&self) -> Vector3<f64> {
        self.anchor.into()
    }

    /// Its velocity.
    pub fn velocity(&self) -> Vector3<f64> {
        self.velocity.into()
    }

    /// Its way from the anchor at a time.
    pub fn way(&self, time: f64) -> Vector3<f64> {
        Vector3::from(self.moved) + self.velocity() * (time - self.time)
    }

    /// The place that angular momenta are about, in the frame.
    pub fn center(&self) -> Vector3<f64> {
        self.center.into()
    }

    /// A global place in the frame.
    pub fn place_from(&self, position_global: &Vector3<f64>, time: f64) -> Vector3<f64> {
        (position_global - self.anchor()) - self.way(time)
    }

    /// A place in the frame, global.
    pub fn global_place(&self, position: &Vector3<f64>, time: f64) -> Vector3<f64> {
        self.anchor() + (self.way(time) + position)
    }

    /// Where it stands from another frame, both at the times from which they have gone steadily.
    pub fn offset_from(&self, other: &Self) -> Vector3<f64> {
        (self.anchor() - other.anchor()) + (Vector3::from(self.moved) - Vector3::from(other.moved))
    }

    /// The frame that has been moved by `shift` at a time, and goes on faster by `velocity`. Angular momenta are about the same place.
    pub fn moved_by(&self, shift: &Vector3<f64>, velocity: &Vector3<f64>, time: f64) -> Self {
        Self {
            anchor: self.anchor,
            moved: (self.way(time) + shift).into(),
            velocity: (self.velocity() + velocity).into(),
            time,
            center: (self.center() - shift).into(),
        }
    }

    /// The same about another place in it.
    pub fn about(self, center: Vector3<f64>) -> Self {
        Self { center: center.into(), ..self }
    }

    /// All its numbers.
    pub fn numbers(&self) -> impl Iterator<Item = f64> + use<> {
        let Self { anchor, moved, velocity, time, center } = *self;
        [time].into_iter().chain(anchor).chain(moved).chain(velocity).chain(center)
    }
}
