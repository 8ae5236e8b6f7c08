//! Settings of a diagram, and its progress.

use diagnostic::{Failure, Kind};
use model::BuildProgress;
use nalgebra::Vector3;

use super::bent::AboutRest;

/// Each speed takes an eigenvalue problem, and a row of a table.
const MAX_SPEEDS: usize = 10_000;

/// How far a diagram has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CampbellProgress {
    /// The model is being built.
    Build(BuildProgress),
    /// The vibrations are followed from speed to speed.
    Speeds {
        /// Speeds that are done.
        done: usize,
        /// All of them.
        total: usize,
    },
}

/// Equally spaced spin speeds, both ends included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Speeds {
    /// The lowest, radians per time, ≥ 0.
    pub start: f64,
    /// The highest, radians per time.
    pub end: f64,
    /// How many, 2 to 10 000.
    pub count: usize,
}

impl Speeds {
    fn values(&self) -> Result<Vec<f64>, Failure> {
        let &Self { start, end, count } = self;
        if !(start >= 0.0 && end > start && end.is_finite() && (2..=MAX_SPEEDS).contains(&count)) {
            let expected =
                format!("start:end:count, radians per time, with 0 ≤ start < end and a count of 2 to {MAX_SPEEDS}");
            let wrong = Kind::Usage.alone().found(format!("{start}:{end}:{count}")).expected(&expected);
            let words = format!("speeds {start}:{end}:{count}: expected {expected}");
            return Err(wrong.help("give a range, such as 0:200:50").says(words));
        }
        let last = (count - 1) as f64;
        Ok((0..count).map(|i| ((last - i as f64) * start + i as f64 * end) / last).collect())
    }
}

/// Settings of a diagram.
#[derive(Debug, Clone, PartialEq)]
pub struct CampbellSettings {
    /// Direction of the spin, any length but zero: of a body alone in the axes of the mesh; of bodies in joints global, through the center of
    /// mass. A body alone needs one.
    pub axis: Option<[f64; 3]>,
    /// A joint about whose axis bodies in joints spin. Without axis and joint it is the joint that a drive turns.
    pub joint: Option<String>,
    /// The spin speeds.
    pub speeds: Speeds,
    /// Engine orders: numbers of times a turn that loads come by.
    pub orders: Vec<f64>,
    /// About what the vibrations of a body alone are.
    pub about_rest: AboutRest,
}

/// The speeds, where they and the orders are in range.
pub(super) fn checked(speeds: Speeds, orders: &[f64]) -> Result<Vec<f64>, Failure> {
    if let Some(&order) = orders.iter().find(|order| !(**order > 0.0 && order.is_finite())) {
        let wrong = Kind::Usage.alone().key("orders").found(order.to_string());
        return Err(wrong.expected("positive numbers of times a turn").help("give some, such as 1, 2 or 0.5").into());
    }
    speeds.values()
}

/// A unit vector along an axis.
pub(super) fn unit(axis: [f64; 3]) -> Result<Vector3<f64>, Failure> {
    let unit = Vector3::from(axis).try_normalize(0.0).filter(|axis| (axis.norm() - 1.0).abs() < 1e-12);
    unit.ok_or_else(|| {
        let expected = "three finite numbers that are not all zero, in the axes of the mesh";
        Kind::Usage.alone().key("axis").found(format!("{axis:?}")).expected(expected).into()
    })
}
