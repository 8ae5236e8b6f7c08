//! Work of the loads and dissipation so far: the other side of the balances of energy and angular momentum.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::simulation::checkpoint::{CheckpointError, finite};

/// Sums since the beginning.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
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
    pub fn add(&mut self, factor: f64, other: &Self) {
        self.work += factor * other.work;
        self.dissipation += factor * other.dissipation;
        self.impulse_global += factor * other.impulse_global;
        self.angular_impulse_global += factor * other.angular_impulse_global;
    }

    /// Refuses numbers that are not finite.
    ///
    /// # Errors
    /// [`CheckpointError::Value`].
    pub fn check(&self) -> Result<(), CheckpointError> {
        let Self { work, dissipation, impulse_global, angular_impulse_global } = self;
        finite("the work", [work, dissipation].into_iter().chain(impulse_global).chain(angular_impulse_global))
    }
}
