//! What loads and damping have done so far: the other side of the balances of energy and angular momentum.

use nalgebra::Vector3;

use crate::checkpoint::StateCoder;

/// Sums since the beginning.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Work {
    /// Work of the loads.
    pub work: f64,
    /// Energy that damping has taken.
    pub dissipation: f64,
    /// Impulse of the loads, global components.
    pub impulse_global: Vector3<f64>,
    /// Angular impulse of the loads about the centre of mass, global components.
    pub angular_impulse_global: Vector3<f64>,
}

impl Work {
    /// Adds `factor` times a rate or a sum.
    pub(crate) fn add(&mut self, factor: f64, other: &Self) {
        self.work += factor * other.work;
        self.dissipation += factor * other.dissipation;
        self.impulse_global += factor * other.impulse_global;
        self.angular_impulse_global += factor * other.angular_impulse_global;
    }
    pub(crate) fn code(&mut self, coder: &mut StateCoder) {
        coder.number(&mut self.work);
        coder.number(&mut self.dissipation);
        coder.vector(&mut self.impulse_global);
        coder.vector(&mut self.angular_impulse_global);
    }
}
