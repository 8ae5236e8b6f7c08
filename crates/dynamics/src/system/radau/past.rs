//! The steps before, as far as the estimated error of a step needs them.

use serde::{Deserialize, Serialize};

use crate::matrix::lists::larger;
use crate::simulation::checkpoint::{CheckpointError, expect, finite};
use crate::system::description::System;

/// Deformation counts over its largest so far, but not over less than this part of what the largest energy would bend the lowest shape by:
/// that has a millionth of the energy.
const STILL: f64 = 1e-3;

/// The steps before, as far as the estimate needs them.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(in crate::system) struct Past {
    /// Rates x' (with the angular velocity in its place) and y' at the start of the last step.
    pub start: [Vec<f64>; 2],
    /// The same at its end.
    pub end: [Vec<f64>; 2],
    /// Steps that follow each other without a jump, at most 2.
    pub steps: u8,
    /// Largest deformation of each body so far, as root mean square over its mass.
    pub largest_deformations: Vec<f64>,
}

impl Past {
    pub fn new(coordinates: usize, bodies: usize) -> Self {
        let rates = || [vec![0.0; coordinates], vec![0.0; coordinates]];
        Self { start: rates(), end: rates(), steps: 0, largest_deformations: vec![0.0; bodies] }
    }

    /// Takes over another, without allocating.
    pub fn copy_from(&mut self, other: &Self) {
        for (own, other) in self.start.iter_mut().chain(&mut self.end).zip(other.start.iter().chain(&other.end)) {
            own.copy_from_slice(other);
        }
        self.largest_deformations.copy_from_slice(&other.largest_deformations);
        self.steps = other.steps;
    }

    /// Deformation that errors of a body count over, up to the start of a step.
    pub fn scale_of_deformation(&self, system: &System, body: usize, energy: f64) -> f64 {
        let least = STILL * (2.0 * energy).sqrt() / system.bodies[body].lowest_frequency();
        self.largest_deformations[body].max(least)
    }

    /// Largest change of a deformation by a change x, over what it counts over; zero where that is zero.
    pub fn relative_deformation(&self, system: &System, x: &[f64], energy: f64) -> f64 {
        let of_body = |body: usize| {
            let own = &x[system.first[body] + 6..system.first[body + 1]];
            let scale = if own.is_empty() { 0.0 } else { self.scale_of_deformation(system, body, energy) };
            if scale == 0.0 { 0.0 } else { own.iter().map(|q| q * q).sum::<f64>().sqrt() / scale }
        };
        (0..system.bodies.len()).map(of_body).fold(0.0, larger)
    }

    /// Refuses that of another system, and numbers that are not finite.
    pub fn check(&self, own: &Self) -> Result<(), CheckpointError> {
        let lengths = |of: &Self| {
            (of.start.each_ref().map(Vec::len), of.end.each_ref().map(Vec::len), of.largest_deformations.len())
        };
        expect("the steps before", lengths(self) == lengths(own) && self.steps <= 2)?;
        let numbers = self.start.iter().chain(&self.end).flatten().chain(&self.largest_deformations);
        finite("the steps before", numbers)
    }
}
