//! The state of a system: one flat list of numbers, and the layout that says what they are.

use std::ops::Range;

use nalgebra::Vector3;
use rigid_kin::Attitude;
use serde::{Deserialize, Serialize};

use crate::error::SetupError;
use crate::matrix::four::{WIDTH, all_finite};

/// A state at a time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Time.
    pub time: f64,
    /// All numbers, in the order of the [`Layout`] of their equations.
    pub values: Vec<f64>,
}

impl State {
    /// Takes over another state of the same equations, without allocating.
    pub fn copy_from(&mut self, other: &Self) {
        self.time = other.time;
        self.values.copy_from_slice(&other.values);
    }
}

/// The order of the numbers of a state: named parts, and which of them are attitudes.
///
/// Each part begins at a multiple of four, so that numbers can be taken four by four; the places between are zero.
#[derive(Debug, Clone, Default)]
pub struct Layout {
    length: usize,
    parts: Vec<(&'static str, Range<usize>)>,
    rotations: Vec<Rotation>,
}

/// An attitude in a list, and the rotation vector by which a step turns it.
#[derive(Debug, Clone)]
pub struct Rotation {
    /// First of the four numbers [w, x, y, z] of the attitude at the start of the step.
    pub attitude: usize,
    /// First of the three numbers of the rotation vector since then, body axes. It is zero in a state.
    pub vector: usize,
    /// Place of the angle about an axis in the body since the beginning, and that axis; of a hinge.
    pub angle: Option<(usize, Vector3<f64>)>,
}

impl Layout {
    /// Adds a part of `count` numbers; returns its first place. Its name is that of an error, after "is not finite:".
    pub fn add(&mut self, name: &'static str, count: usize) -> usize {
        let first = self.length;
        self.parts.push((name, first..first + count));
        self.length = (first + count).next_multiple_of(WIDTH);
        first
    }

    /// Declares an attitude, and what turns it.
    pub fn rotate(&mut self, rotation: Rotation) {
        self.rotations.push(rotation);
    }

    /// Number of places.
    pub fn len(&self) -> usize {
        self.length
    }

    /// True without any part.
    pub fn is_empty(&self) -> bool {
        self.length == 0
    }

    /// A list of zeros, all attitudes unturned.
    pub fn zeros(&self) -> Vec<f64> {
        let mut values = vec![0.0; self.length];
        self.rotations.iter().for_each(|rotation| values[rotation.attitude] = 1.0);
        values
    }

    /// Makes a state of the end of a step from `from`: attitudes are turned by their rotation vectors, which return to zero.
    pub fn turn(&self, from: &[f64], values: &mut [f64]) {
        for Rotation { attitude, vector, angle } in &self.rotations {
            let theta = vector_at(values, *vector);
            let turned = attitude_at(from, *attitude).advanced_by(&theta);
            values[*attitude..*attitude + 4].copy_from_slice(&turned.wxyz());
            values[*vector..*vector + 3].fill(0.0);
            if let Some((place, axis)) = angle {
                values[*place] = from[*place] + axis.dot(&theta);
            }
        }
    }

    /// Largest angle between the attitudes of two lists, rad.
    pub fn angle_between(&self, a: &[f64], b: &[f64]) -> f64 {
        let angle =
            |rotation: &Rotation| attitude_at(a, rotation.attitude).angle_to(&attitude_at(b, rotation.attitude));
        // A NaN stays one.
        self.rotations.iter().map(angle).fold(0.0, |most, angle| if angle <= most { most } else { angle })
    }

    /// Name of the first part with a number that is not finite.
    pub fn not_finite(&self, values: &[f64]) -> Option<&'static str> {
        if all_finite(values) {
            return None;
        }
        self.parts.iter().find(|(_, range)| !all_finite(&values[range.clone()])).map(|(name, _)| *name)
    }

    /// Refuses a state of another length, and numbers that are not finite or no attitude.
    ///
    /// # Errors
    /// [`SetupError`].
    pub fn check(&self, state: &State) -> Result<(), SetupError> {
        let (expected, found) = (self.length, state.values.len());
        if found != expected {
            return Err(SetupError::Length { what: "the state", expected, found });
        }
        let numbers = std::iter::once(&state.time).chain(&state.values);
        if let Some(found) = numbers.copied().find(|x| !x.is_finite()) {
            return Err(SetupError::Value { what: "a value of the state", found, expected: "a finite number" });
        }
        for Rotation { attitude, .. } in &self.rotations {
            let wxyz = wxyz_at(&state.values, *attitude);
            if Attitude::from_unit_wxyz(wxyz).is_err() {
                let found = wxyz.iter().map(|x| x * x).sum::<f64>().sqrt();
                return Err(SetupError::Value { what: "the length of an attitude", found, expected: "1" });
            }
        }
        Ok(())
    }
}

/// The three numbers from a place on.
pub fn vector_at(values: &[f64], first: usize) -> Vector3<f64> {
    Vector3::new(values[first], values[first + 1], values[first + 2])
}

/// The attitude from a place on.
pub fn attitude_at(values: &[f64], first: usize) -> Attitude {
    Attitude::from_wxyz_unchecked(wxyz_at(values, first))
}

fn wxyz_at(values: &[f64], first: usize) -> [f64; 4] {
    std::array::from_fn(|i| values[first + i])
}
