//! Every way of holding the block of these tests.

use faer::Mat;
use modal::Support;
use nalgebra::Vector3;
use reduced_body::RigidMotion;

use crate::bodies::{Body, block};

pub const SIZE: [f64; 3] = [30.0, 14.0, 9.0];

pub fn body() -> Body {
    block(SIZE, [3, 2, 1])
}

/// Nodes of which the position says so.
pub fn nodes(positions: &[[f64; 3]], is_in: impl Fn(&Vector3<f64>) -> bool) -> Vec<u32> {
    (0..positions.len() as u32).filter(|node| is_in(&positions[*node as usize].into())).collect()
}

/// Supports of the block, with the number of rigid modes that they leave.
pub fn supports(positions: &[[f64; 3]]) -> [(Support, usize); 8] {
    let corner = Vector3::new(-15.0, -7.0, -4.5);
    let near_corner = nodes(positions, |x| (x - corner).norm() < 8.0);
    let left = nodes(positions, |x| x.x < -14.9);
    let held = |motion, nodes: &Vec<u32>| Support::new(motion, nodes.clone());
    let axis = Vector3::z();
    let oblique = Vector3::new(2.0, -1.0, 2.0) / 3.0;
    [
        (Support::free(), 6),
        (held(RigidMotion::pin(corner), &nodes(positions, |x| *x == corner)), 3),
        (held(RigidMotion::pin(corner), &near_corner), 3),
        (held(RigidMotion::hinge(corner, axis), &nodes(positions, |x| x.xy() == corner.xy())), 1),
        (held(RigidMotion::hinge(corner, oblique), &near_corner), 1),
        (held(RigidMotion::clamp(corner), &left), 0),
        (held(RigidMotion::slider(Vector3::y()), &left), 1),
        (held(RigidMotion::slider(oblique), &near_corner), 1),
    ]
}

/// A basis of the displacements that a support allows: all of the other nodes', and what each rigid motion does to the
/// held ones.
pub fn allowed(support: &Support, positions: &[[f64; 3]]) -> Mat<f64> {
    let is_held = |node: usize| support.nodes.contains(&(node as u32));
    let moved = |x: Vector3<f64>| -> Vec<Vector3<f64>> {
        if support.motion.is_free() {
            return Vec::new();
        }
        let point = support.motion.fixed_point().unwrap_or_default();
        let turned = support.motion.rotations().iter().map(|axis| axis.cross(&(x - point)));
        support.motion.translations().iter().copied().chain(turned).collect()
    };
    let others: Vec<usize> = (0..3 * positions.len()).filter(|i| !is_held(i / 3)).collect();
    let common: Vec<Vec<f64>> = (0..moved(Vector3::zeros()).len())
        .map(|k| {
            let of = |i: usize| if is_held(i / 3) { moved(positions[i / 3].into())[k][i % 3] } else { 0.0 };
            (0..3 * positions.len()).map(of).collect()
        })
        // A pin or hinge on its own nodes leaves them where they are.
        .filter(|column: &Vec<f64>| column.iter().any(|u| u.abs() > 1e-12))
        .collect();
    Mat::from_fn(3 * positions.len(), others.len() + common.len(), |i, j| match others.get(j) {
        Some(row) => f64::from(i == *row),
        None => common[j - others.len()][i],
    })
}
