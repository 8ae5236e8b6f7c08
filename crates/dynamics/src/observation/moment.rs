//! The motion at every step, as far as it costs nothing.

use nalgebra::Vector3;

/// The motion at a time that the steps pass through, borrowed from the run: of the conservative form with fixed steps the
/// start of each step, else its end.
#[derive(Debug, Clone, Copy)]
pub struct Moment<'a> {
    /// Time.
    pub time: f64,
    /// Angular velocity of the body frame, body components.
    pub omega_body: Vector3<f64>,
    /// Flexible modal displacements (nf).
    pub modal_displacement: &'a [f64],
    /// Flexible modal velocities (nf).
    pub modal_velocity: &'a [f64],
}
