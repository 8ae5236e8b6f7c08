//! The size of an error beside the motion: what step control keeps within its tolerance.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::equations::Equations;
use crate::simulation::checkpoint::{CheckpointError, finite};
use crate::state::State;

/// Squares of the sizes of a motion, or of the difference of two states.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Sizes {
    /// Energy, that of the origin's motion left out where it is a motion's.
    pub energy: f64,
    /// Σ q², which is ∫ ρ |u|² dV.
    pub displacement: f64,
    /// ∫ ρ |a|² dV of the rigid motion and of the modes.
    pub acceleration: f64,
}

/// Part of the motion, as a ratio of amplitudes, below which a vibration is taken as rounding.
const STILL: f64 = 1e-6;

impl Sizes {
    /// The larger of each.
    pub(crate) fn max(self, other: Self) -> Self {
        Self {
            energy: self.energy.max(other.energy),
            displacement: self.displacement.max(other.displacement),
            acceleration: self.acceleration.max(other.acceleration),
        }
    }

    /// Refuses numbers that are not finite.
    pub(crate) fn check(&self) -> Result<(), CheckpointError> {
        finite("the size of the motion", [&self.energy, &self.displacement, &self.acceleration])
    }

    /// The largest of the three beside those of a motion of a body with this lowest ω_k.
    pub(crate) fn relative_to(self, motion: Self, lowest: f64) -> f64 {
        // What vibrates with less is rounding.
        let still = STILL * STILL * motion.energy;
        let square = lowest * lowest;
        let pairs = [
            (self.energy, motion.energy),
            (self.displacement, motion.displacement.max(still / square)),
            (self.acceleration, motion.acceleration.max(still * square)),
        ];
        let ratios = pairs.map(|(error, whole)| if error == 0.0 { 0.0 } else { (error / whole).sqrt() });
        // A NaN stays one.
        ratios.into_iter().fold(0.0, |most, ratio| if ratio <= most { most } else { ratio })
    }
}

/// A measure of the errors of steps in one run, so that the errors of all steps add up to that at the end.
pub trait ErrorNorm<E: Equations>: fmt::Debug + Send + Sync {
    /// Sizes of the motion at a state, where `e` has the rates.
    fn motion(&self, equations: &E, state: &State, e: &E::Evaluation) -> Sizes;

    /// Sizes of the difference of two states at the end of a `step`, of which the first was reached by halves of it. An error
    /// of first order in time counts `gain` times, since all are divided by it.
    fn difference(&self, equations: &E, states: [&State; 2], step: f64, gain: f64) -> Sizes;

    /// Sizes of an error of a step that steps of half its length do not show.
    fn unseen(&self, equations: &E, step: f64, end: &StepDone<'_, E>) -> Sizes {
        let _ = (equations, step, end);
        Sizes::default()
    }

    /// Lowest ω_k; infinite without modes.
    fn lowest_frequency(&self, equations: &E) -> f64 {
        let _ = equations;
        f64::INFINITY
    }
}

/// The end of a step, and the rates some time before it.
#[derive(Debug)]
pub struct StepDone<'a, E: Equations> {
    /// The state at the end.
    pub state: &'a State,
    /// The rates there, without the linear part.
    pub e: &'a E::Evaluation,
    /// Rates before.
    pub before: &'a E::Evaluation,
    /// Time between the two.
    pub since: f64,
}

/// The root of the sum of all squares.
#[derive(Debug, Clone, Copy)]
pub struct PlainNorm;

impl<E: Equations> ErrorNorm<E> for PlainNorm {
    fn motion(&self, _: &E, state: &State, _: &E::Evaluation) -> Sizes {
        Sizes { displacement: state.values.iter().map(|x| x * x).sum(), ..Sizes::default() }
    }

    fn difference(&self, _: &E, [a, b]: [&State; 2], _: f64, _: f64) -> Sizes {
        let squares = a.values.iter().zip(&b.values).map(|(a, b)| (a - b) * (a - b));
        Sizes { displacement: squares.sum(), ..Sizes::default() }
    }
}
