//! The wrenches that one scalar of two markers puts on them.

use nalgebra::Vector3;

use crate::system::marker::MarkerPlace;
use crate::system::marker::motion::MarkerMotion;

/// A scalar of two markers where they are: its value, and the forces and moments (global) that do its work. Their sum has no
/// force and no moment, also where the value of a row is not zero.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RowWrench {
    pub residual: f64,
    /// Rate of the residual where nothing moves: by a drive.
    pub own_rate: f64,
    /// On j; on i it is the opposite.
    pub force: Vector3<f64>,
    /// On i and on j, each at its marker.
    pub moments: [Vector3<f64>; 2],
}

impl RowWrench {
    /// The distance from i to j along an axis of one of them (0 for i, 1 for j).
    pub fn along([i, j]: [&MarkerPlace; 2], of: usize, e: Vector3<f64>) -> Self {
        let d = j.position - i.position;
        let mut moments = [Vector3::zeros(); 2];
        moments[of] = e.cross(&d);
        Self { residual: e.dot(&d), own_rate: 0.0, force: e, moments }
    }

    /// A scalar that turns change, by its moment on i.
    pub fn turning(residual: f64, moment: Vector3<f64>) -> Self {
        Self { residual, own_rate: 0.0, force: Vector3::zeros(), moments: [moment, -moment] }
    }

    /// Forces and moments on the two.
    pub fn on_both(&self) -> [[Vector3<f64>; 2]; 2] {
        [[-self.force, self.moments[0]], [self.force, self.moments[1]]]
    }

    /// The rate of the scalar in a motion.
    pub fn rate(&self, motions: [&MarkerMotion; 2]) -> f64 {
        let of = |(motion, [force, moment]): (&MarkerMotion, [Vector3<f64>; 2])| {
            force.dot(&motion.velocity_global) + moment.dot(&motion.omega_global)
        };
        self.own_rate + motions.into_iter().zip(self.on_both()).map(of).sum::<f64>()
    }
}
