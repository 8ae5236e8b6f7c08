//! Motions of markers, and what acts on them.

use nalgebra::{Matrix3, Vector3};

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
