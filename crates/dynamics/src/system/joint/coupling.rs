//! Couplings of joints: gears, racks, screws. Eq. (J13) of `docs/method/systems.md`.

use crate::system::joint::coordinate::Coordinate;

/// A sum of coordinates of joints that stays as it is: one more row.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub struct Coupling {
    /// Its name in errors and results.
    pub name: String,
    /// The terms of the sum.
    pub terms: Vec<CoupledCoordinate>,
    /// The sum; `None` is that of the bodies as they are placed at first.
    pub sum: Option<f64>,
}

/// A coordinate of a joint, times a factor.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct CoupledCoordinate {
    /// The number of the joint in its system.
    pub joint: usize,
    /// Its turn (rad) or its slide.
    pub coordinate: Coordinate,
    /// The factor.
    pub factor: f64,
}

impl Coupling {
    fn new(name: &str, terms: [(usize, Coordinate, f64); 2]) -> Self {
        let terms = terms.map(|(joint, coordinate, factor)| CoupledCoordinate { joint, coordinate, factor });
        Self { name: name.to_owned(), terms: terms.to_vec(), sum: None }
    }

    /// The first of two joints turns `ratio` times as much as the second; the ratio of two outer gears is negative.
    pub fn gear(name: &str, joints: [usize; 2], ratio: f64) -> Self {
        Self::new(name, [(joints[0], Coordinate::Turn, 1.0), (joints[1], Coordinate::Turn, -ratio)])
    }

    /// The second of two joints slides by `radius` for each radian that the first one turns.
    pub fn rack(name: &str, joints: [usize; 2], radius: f64) -> Self {
        Self::new(name, [(joints[1], Coordinate::Slide, 1.0), (joints[0], Coordinate::Turn, -radius)])
    }

    /// A joint slides by `lead` for each full turn.
    pub fn screw(name: &str, joint: usize, lead: f64) -> Self {
        Self::rack(name, [joint; 2], lead / std::f64::consts::TAU)
    }
}
