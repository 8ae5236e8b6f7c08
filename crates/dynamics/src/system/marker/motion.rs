//! Motions of markers, and what acts on them.

use nalgebra::{Matrix3, Vector3};
use rigid_kin::transformation_matrix;

/// A marker in motion, all global.
#[derive(Debug, Clone, Copy)]
pub struct MarkerMotion {
    /// Its position.
    pub position_global: Vector3<f64>,
    /// Its axes, as columns.
    pub axes_global: Matrix3<f64>,
    /// Its velocity.
    pub velocity_global: Vector3<f64>,
    /// Its angular velocity.
    pub omega_global: Vector3<f64>,
}

/// A force and a moment on a marker, global.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct MarkerWrench {
    /// The force.
    pub force_global: Vector3<f64>,
    /// The moment about the marker.
    pub moment_global: Vector3<f64>,
}

/// A small change of the motion of a marker, global.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct MarkerChange {
    /// Its displacement.
    pub displacement_global: Vector3<f64>,
    /// The rotation vector by which its axes turn.
    pub turn_global: Vector3<f64>,
    /// Change of its velocity.
    pub velocity_global: Vector3<f64>,
    /// Change of its angular velocity.
    pub omega_global: Vector3<f64>,
}

impl MarkerMotion {
    /// The motion after `factor` times a change.
    pub(crate) fn changed(&self, change: &MarkerChange, factor: f64) -> Self {
        Self {
            position_global: self.position_global + change.displacement_global * factor,
            axes_global: transformation_matrix(&(change.turn_global * -factor)) * self.axes_global,
            velocity_global: self.velocity_global + change.velocity_global * factor,
            omega_global: self.omega_global + change.omega_global * factor,
        }
    }
}
