//! Springs, dampers and bushings between markers.

use nalgebra::Vector3;
use rigid_kin::rotation_vector;

use crate::system::element::ForceElement;
use crate::system::marker::Marker;
use crate::system::motion::{MarkerMotion, MarkerWrench};

/// A spring and a damper along the line between two markers.
#[derive(Debug, Clone)]
pub struct PointSpring {
    /// Its ends.
    pub markers: [Marker; 2],
    /// Force per length.
    pub stiffness: f64,
    /// Force per velocity.
    pub damping: f64,
    /// Length without force.
    pub free_length: f64,
}

impl ForceElement for PointSpring {
    fn markers(&self) -> &[Marker] {
        &self.markers
    }

    fn apply(&self, _: [f64; 2], motions: &[MarkerMotion], wrenches: &mut [MarkerWrench]) {
        let ([i, j], [on_i, on_j]) = (motions, wrenches) else { return };
        let line = j.position_global - i.position_global;
        let length = line.norm();
        if length == 0.0 {
            return;
        }
        let along = line / length;
        let rate = along.dot(&(j.velocity_global - i.velocity_global));
        let force = along * (self.stiffness * (length - self.free_length) + self.damping * rate);
        (on_i.force_global, on_j.force_global) = (force, -force);
    }
}

/// Springs and dampers along and about the axes of the first of two markers, for small turns of the second against it.
#[derive(Debug, Clone)]
pub struct Bushing {
    /// i, whose axes count, and j.
    pub markers: [Marker; 2],
    /// Force per displacement along each axis, and moment per angle about it.
    pub stiffness: [Vector3<f64>; 2],
    /// Force per velocity, and moment per angular velocity.
    pub damping: [Vector3<f64>; 2],
}

impl ForceElement for Bushing {
    fn markers(&self) -> &[Marker] {
        &self.markers
    }

    fn apply(&self, _: [f64; 2], motions: &[MarkerMotion], wrenches: &mut [MarkerWrench]) {
        let ([i, j], [on_i, on_j]) = (motions, wrenches) else { return };
        let line = j.position_global - i.position_global;
        let [moved, rate] = [line, j.velocity_global - i.velocity_global - i.omega_global.cross(&line)]
            .map(|vector| i.axes_global.tr_mul(&vector));
        // A turn by half a turn has no vector: then there is no spring, either.
        let turned = rotation_vector(&(j.axes_global.transpose() * i.axes_global)).unwrap_or_default();
        let spin = i.axes_global.tr_mul(&(j.omega_global - i.omega_global));
        let law = |which: usize, by: Vector3<f64>, rate: Vector3<f64>| {
            i.axes_global * (self.stiffness[which].component_mul(&by) + self.damping[which].component_mul(&rate))
        };
        let (force, moment) = (law(0, moved, rate), law(1, turned, spin));
        on_j.force_global = -force;
        on_j.moment_global = -moment;
        on_i.force_global = force;
        on_i.moment_global = moment + line.cross(&force);
    }
}
