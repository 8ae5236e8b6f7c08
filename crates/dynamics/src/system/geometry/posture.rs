//! Where the bodies and joints of a system are, for all that looks at geometry alone.

use nalgebra::{Matrix3, Vector3};

use crate::system::constraints::End;
use crate::system::description::System;
use crate::system::joint::Joint;

/// Where the bodies and joints of a system are.
#[derive(Debug, Clone)]
pub(crate) struct Posture<'a> {
    /// Origins of the bodies, from the frame of the first, and their transformation matrices.
    pub positions: Vec<Vector3<f64>>,
    pub attitudes: &'a [Matrix3<f64>],
    /// The ends of the rows.
    pub ends: &'a [Vec<End>],
    /// The second marker of each joint, from there.
    pub points: Vec<Vector3<f64>>,
}

impl<'a> Posture<'a> {
    /// By places in the frames of the bodies, of joints at their second markers.
    pub fn new(
        system: &System,
        positions: impl Iterator<Item = Vector3<f64>>,
        points: impl Iterator<Item = Vector3<f64>>,
        attitudes: &'a [Matrix3<f64>],
        ends: &'a [Vec<End>],
    ) -> Self {
        let first = system.bodies.first().map(|body| &body.frame);
        let offset = |b: usize| first.map_or_else(Vector3::zeros, |first| system.bodies[b].frame.offset_from(first));
        let of_joint = |(joint, point): (&Joint, Vector3<f64>)| {
            let body = joint.markers.iter().find_map(|marker| marker.body());
            point + body.map_or_else(Vector3::zeros, offset)
        };
        Self {
            positions: positions.enumerate().map(|(b, position)| position + offset(b)).collect(),
            attitudes,
            ends,
            points: system.connections.joints.iter().zip(points).map(of_joint).collect(),
        }
    }
}
