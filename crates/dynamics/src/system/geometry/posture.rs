//! Where the bodies and joints of a system are, for all that looks at geometry alone.

use nalgebra::{Matrix3, Vector3};

use crate::system::constraints::End;

/// Where the bodies and joints of a system are.
#[derive(Debug, Clone)]
pub(crate) struct Posture<'a> {
    /// Origins of the bodies, global, and their transformation matrices.
    pub positions: &'a [Vector3<f64>],
    pub attitudes: &'a [Matrix3<f64>],
    /// The ends of the rows.
    pub ends: &'a [Vec<End>],
    /// The second marker of each joint, global.
    pub points: Vec<Vector3<f64>>,
}
