//! Forces between markers: springs, dampers, bushings, and laws from outside.

use std::fmt;

use nalgebra::Vector3;
use rigid_kin::rotation_vector;

use crate::system::marker::Marker;
use crate::system::motion::{MarkerMotion, MarkerWrench};

/// A law that puts forces on some markers by their motion.
///
/// Where the wrenches sum to no force and no moment, momenta are kept. What it does is its work, in
/// [`SystemMotion::element_work`](crate::SystemMotion::element_work).
pub trait ForceElement: fmt::Debug + Send + Sync {
    /// Its markers.
    fn markers(&self) -> &[Marker];

    /// Finds the wrench on each of its markers at a time; laws with branches are taken as they are at the time `times[1]`.
    /// `wrenches` are zero before.
    fn apply(&self, times: [f64; 2], motions: &[MarkerMotion], wrenches: &mut [MarkerWrench]);
}

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

/// A spring and a damper about the z axis that two markers share, with stops.
#[derive(Debug, Clone)]
pub struct TurnSpring {
    /// i and j.
    pub markers: [Marker; 2],
    /// Moment per angle, and per angular velocity.
    pub stiffness: f64,
    /// Moment per angular velocity.
    pub damping: f64,
    /// Angle of j against i without a moment, rad, within half a turn of zero.
    pub free_angle: f64,
    /// Stops: lowest and highest angle, moment per angle and per angular velocity beyond. They are stiff springs on one side,
    /// which push and do not pull.
    pub stops: Option<Stops>,
}

/// Stops of a turn.
#[derive(Debug, Clone, Copy)]
pub struct Stops {
    /// Lowest and highest angle, rad.
    pub angles: [f64; 2],
    /// Moment per angle beyond them.
    pub stiffness: f64,
    /// Moment per angular velocity, while they are touched.
    pub damping: f64,
}

impl ForceElement for TurnSpring {
    fn markers(&self) -> &[Marker] {
        &self.markers
    }

    fn apply(&self, _: [f64; 2], motions: &[MarkerMotion], wrenches: &mut [MarkerWrench]) {
        let ([i, j], [on_i, on_j]) = (motions, wrenches) else { return };
        let axis: Vector3<f64> = i.axes_global.column(2).into();
        let x = i.axes_global.tr_mul(&j.axes_global.column(0));
        let angle = x.y.atan2(x.x);
        let spin = axis.dot(&(j.omega_global - i.omega_global));
        let mut moment = -self.stiffness * (angle - self.free_angle) - self.damping * spin;
        if let Some(Stops { angles: [low, high], stiffness, damping }) = self.stops {
            if angle > high {
                moment += (-stiffness * (angle - high) - damping * spin).min(0.0);
            } else if angle < low {
                moment += (-stiffness * (angle - low) - damping * spin).max(0.0);
            }
        }
        (on_i.moment_global, on_j.moment_global) = (axis * -moment, axis * moment);
    }
}
