//! Places with axes that bodies carry: the ends of joints.
//!
//! Eqs. (J1)–(J3) and (J15) of `docs/method/systems.md`.

pub(crate) mod motion;
pub(crate) mod tangent;

use nalgebra::{Matrix3, Vector3};
use rigid_kin::{cross_matrix, transformation_matrix};

use crate::body::second_order::SecondOrder;
use crate::body::shapes::{PointShapes, RotationShapes};
use crate::system::marker::motion::MarkerMotion;

/// A place with axes on a body, or on the ground.
///
/// On a flexible body it is the mean of a patch, or a node: the modes move it by Ψ q and turn it by the rotation vector Θ q, both to
/// second order where the shapes know it: then the forces of joints and elements stiffen the body.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub struct Marker {
    body: Option<usize>,
    /// X, from the origin of the body in its axes; of the ground, global.
    position: Vector3<f64>,
    /// Columns of Ψ (nf).
    displacement: Vec<Vector3<f64>>,
    /// Columns of Θ (nf).
    rotation: Vec<Vector3<f64>>,
    /// Displacement and rotation of second order.
    second_order: [Option<SecondOrder>; 2],
    /// The axes as columns, body axes; of the ground, global.
    axes: Matrix3<f64>,
}

impl Marker {
    /// A place on the ground: its position and its axes as columns, global.
    pub fn on_ground(position_global: Vector3<f64>, axes_global: Matrix3<f64>) -> Self {
        Self {
            body: None,
            position: position_global,
            displacement: Vec::new(),
            rotation: Vec::new(),
            second_order: [None, None],
            axes: axes_global,
        }
    }

    /// A place that a body carries as if it were rigid: its position from the body's origin and its axes as columns, body axes.
    pub fn on_rigid(body: usize, position_body: Vector3<f64>, axes_body: Matrix3<f64>) -> Self {
        Self { body: Some(body), ..Self::on_ground(position_body, axes_body) }
    }

    /// A place that the modes of a body move and turn; its axes as columns, body axes.
    pub fn on_flexible(body: usize, point: &PointShapes, turning: &RotationShapes, axes_body: Matrix3<f64>) -> Self {
        Self {
            displacement: point.columns()[6..].to_vec(),
            rotation: turning.columns()[6..].to_vec(),
            second_order: [point.second_order(), turning.second_order()].map(Option::<&SecondOrder>::cloned),
            ..Self::on_rigid(body, point.position_body(), axes_body)
        }
    }

    /// The number of its body; `None` on the ground.
    pub fn body(&self) -> Option<usize> {
        self.body
    }

    /// True if the modes move and turn it as these shapes say.
    pub fn is_of(&self, point: &PointShapes, turning: &RotationShapes) -> bool {
        self.position == point.position_body()
            && self.displacement == point.columns()[6..]
            && self.rotation == turning.columns()[6..]
    }

    /// Number of modes that move it.
    pub(crate) fn flexible(&self) -> usize {
        self.displacement.len()
    }

    /// The least number of modes that a displacement of second order knows.
    pub(crate) fn least_of_second_order(&self) -> Option<usize> {
        self.second_order.iter().flatten().map(SecondOrder::modes).min()
    }

    /// The marker where its body is.
    pub(crate) fn place(&self, body: Option<&BodyPlace<'_>>) -> MarkerPlace {
        let Some(BodyPlace { origin, body_from_global, q }) = body else {
            return MarkerPlace {
                position: self.position,
                axes: self.axes,
                arm: Vector3::zeros(),
                body_from_global: Matrix3::identity(),
                tangent: Matrix3::identity(),
            };
        };
        let global_from_body = body_from_global.transpose();
        if self.displacement.is_empty() {
            return MarkerPlace {
                position: origin + global_from_body * self.position,
                axes: global_from_body * self.axes,
                arm: self.position,
                body_from_global: *body_from_global,
                tangent: Matrix3::identity(),
            };
        }
        let (mut arm, mut theta) = (self.position, Vector3::zeros());
        for ((psi, turn), q) in self.displacement.iter().zip(&self.rotation).zip(*q) {
            arm += psi * *q;
            theta += turn * *q;
        }
        for (sum, second_order) in [&mut arm, &mut theta].into_iter().zip(&self.second_order) {
            *sum += second_order.as_ref().map_or_else(Vector3::zeros, |of| of.displacement(q));
        }
        MarkerPlace {
            position: origin + global_from_body * arm,
            axes: global_from_body * transformation_matrix(&-theta) * self.axes,
            arm,
            body_from_global: *body_from_global,
            tangent: tangent_of(&theta),
        }
    }

    /// The motion of the marker, by its place and the modal displacements and velocities (V and ω in body axes, q̇) of its body.
    pub(crate) fn motion(&self, place: &MarkerPlace, [q, velocities]: [&[f64]; 2]) -> MarkerMotion {
        let (mut velocity, mut omega) = (Vector3::zeros(), Vector3::zeros());
        if let v @ [_, _, _, _, _, _, ..] = velocities {
            let [of_origin, spin] = [0, 3].map(|first| Vector3::new(v[first], v[first + 1], v[first + 2]));
            (velocity, omega) = (of_origin + spin.cross(&place.arm), Vector3::zeros());
            for ((psi, turn), rate) in self.displacement.iter().zip(&self.rotation).zip(&v[6..]) {
                velocity += psi * *rate;
                omega += turn * *rate;
            }
            for (sum, second_order) in [&mut velocity, &mut omega].into_iter().zip(&self.second_order) {
                *sum += second_order.as_ref().map_or_else(Vector3::zeros, |of| of.velocity(q, &v[6..]));
            }
            omega = spin + place.tangent * omega;
        }
        MarkerMotion {
            position_global: place.position,
            axes_global: place.axes,
            velocity_global: place.body_from_global.tr_mul(&velocity),
            omega_global: place.body_from_global.tr_mul(&omega),
        }
    }

    /// Adds a force and a moment (global, at the marker) to generalised forces of its body, which has these modal displacements: force,
    /// moment about the origin, both in body axes, modal forces.
    pub(crate) fn add_wrench(
        &self,
        place: &MarkerPlace,
        q: &[f64],
        [force, moment]: [&Vector3<f64>; 2],
        generalised: &mut [f64],
    ) {
        let [force_body, moment_body] = [force, moment].map(|vector| place.body_from_global * vector);
        let about_origin = place.arm.cross(&force_body) + moment_body;
        for i in 0..3 {
            generalised[i] += force_body[i];
            generalised[3 + i] += about_origin[i];
        }
        let turning = place.tangent.tr_mul(&moment_body);
        let shapes = self.displacement.iter().zip(&self.rotation);
        for (generalised, (psi, turn)) in generalised[6..].iter_mut().zip(shapes) {
            *generalised += psi.dot(&force_body) + turn.dot(&turning);
        }
        for (vector, second_order) in [&force_body, &turning].into_iter().zip(&self.second_order) {
            if let Some(second_order) = second_order {
                second_order.add_force(vector, q, &mut generalised[6..]);
            }
        }
    }
}

/// The position of a body: its origin, its attitude, its modal displacements.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BodyPlace<'a> {
    pub origin: Vector3<f64>,
    pub body_from_global: Matrix3<f64>,
    pub q: &'a [f64],
}

/// A marker where its body is.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MarkerPlace {
    /// Global.
    pub position: Vector3<f64>,
    /// Columns, global.
    pub axes: Matrix3<f64>,
    /// From the origin of the body, body axes.
    arm: Vector3<f64>,
    body_from_global: Matrix3<f64>,
    /// T: the angular velocity of the marker in the body is T Θ q̇.
    tangent: Matrix3<f64>,
}

/// T(θ) = 1 + (1 − cos t)/t² [θ×] + (t − sin t)/t³ [θ×]², t = |θ|.
pub(crate) fn tangent_of(theta: &Vector3<f64>) -> Matrix3<f64> {
    let t = theta.norm();
    let (first, second) = if t < 1e-2 {
        let square = t * t;
        (0.5 - square / 24.0 * (1.0 - square / 30.0), 1.0 / 6.0 - square / 120.0 * (1.0 - square / 42.0))
    } else {
        ((1.0 - t.cos()) / (t * t), (t - t.sin()) / (t * t * t))
    };
    let cross = cross_matrix(theta);
    Matrix3::identity() + cross * first + cross * cross * second
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Along each axis another symmetric matrix.
    fn second_order(size: f64) -> SecondOrder {
        let of = |axis: usize| {
            let entry = |i: usize, j: usize| size * (1.0 + axis as f64 + (i * j) as f64 - 0.5 * (i + j) as f64);
            (Vector3::ith(axis, 1.0), faer::Mat::from_fn(3, 3, entry))
        };
        SecondOrder::new((0..3).map(of).collect()).unwrap()
    }

    /// Independent reference: central differences of the place: the virtual work of a force and a moment is that of
    /// their generalised forces.
    #[test]
    fn generalised_forces_do_the_work_of_their_wrench() {
        let shapes = |seed: f64| -> Vec<Vector3<f64>> {
            (0..3).map(|k| Vector3::new(0.1, -0.2, 0.3) * (seed + f64::from(k))).collect()
        };
        let marker = Marker {
            body: Some(0),
            position: Vector3::new(0.4, -0.3, 0.2),
            displacement: shapes(0.7),
            rotation: vec![Vector3::x(), Vector3::new(0.3, 1.0, -0.2), Vector3::new(-0.5, 0.1, 0.8)],
            second_order: [0.3, -0.4].map(|size| Some(second_order(size))),
            axes: Matrix3::identity(),
        };
        let at = |delta: f64, direction: usize| {
            let start = transformation_matrix(&Vector3::new(0.2, -0.5, 0.3));
            let mut q = [0.3, -0.2, 0.4];
            let (mut origin, mut theta) = (Vector3::new(1.0, 2.0, 3.0), Vector3::zeros());
            match direction {
                // Along the axes of the body.
                0..3 => origin += start.row(direction).transpose() * delta,
                3..6 => theta[direction - 3] += delta,
                _ => q[direction - 6] += delta,
            }
            let body_from_global = transformation_matrix(&theta) * start;
            marker.place(Some(&BodyPlace { origin, body_from_global, q: &q }))
        };
        let [force, moment] = [Vector3::new(1.0, -2.0, 0.5), Vector3::new(0.3, 0.7, -1.1)];
        let mut generalised = [0.0; 9];
        marker.add_wrench(&at(0.0, 0), &[0.3, -0.2, 0.4], [&force, &moment], &mut generalised);
        let delta = 1e-5;
        for (direction, found) in generalised.into_iter().enumerate() {
            let [back, ahead] = [at(-delta, direction), at(delta, direction)];
            let turned = ahead.axes * back.axes.transpose();
            let turn = 0.5
                * Vector3::new(
                    turned[(2, 1)] - turned[(1, 2)],
                    turned[(0, 2)] - turned[(2, 0)],
                    turned[(1, 0)] - turned[(0, 1)],
                );
            let work = force.dot(&(ahead.position - back.position)) + moment.dot(&turn);
            assert!((work / (2.0 * delta) - found).abs() < 1e-9, "{direction}: {work} {found}");
        }
    }
}
