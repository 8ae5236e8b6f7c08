//! Places with axes that bodies carry: the ends of joints.
//!
//! Eqs. (J1)–(J3), (J15) and (J19) of `docs/method/systems.md`.

pub(crate) mod motion;
pub(crate) mod tangent;

use nalgebra::{Matrix3, Vector3};
use rigid_kin::{cross_matrix, transformation_matrix};

use crate::body::patch_turn::{PatchFit, PatchTurn};
use crate::body::second_order::SecondOrder;
use crate::body::shapes::{PointShapes, RotationShapes};
use crate::conservative::manifold::{BentPlace, Manifold};
use crate::system::marker::motion::MarkerMotion;

/// A place with axes on a body, or on the ground.
///
/// On a flexible body it is the mean of a patch, or a node: the modes move it by Ψ q and turn it by the rotation vector Θ q, both to
/// second order where the shapes know it: then the forces of joints and elements stiffen the body. On a body with large modes they move
/// it by Ψ ξ(q), and turn it by the rotation that fits its nodes best, however far it goes.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub struct Marker {
    body: Option<usize>,
    /// X, from the origin of the body in its axes; of the ground, global.
    position: Vector3<f64>,
    /// The place that a marker of the ground is counted from in a system.
    #[serde(skip)]
    anchor: Vector3<f64>,
    /// Columns of Ψ (nf); on a manifold of large modes those of its coordinates z.
    displacement: Vec<Vector3<f64>>,
    /// Columns of Θ, as many; zeros where there is a patch.
    rotation: Vec<Vector3<f64>>,
    /// How far its nodes turn, where large modes turn them.
    patch: Option<PatchTurn>,
    /// True if the columns are those of z.
    is_bent: bool,
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
            anchor: Vector3::zeros(),
            displacement: Vec::new(),
            rotation: Vec::new(),
            patch: None,
            is_bent: false,
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

    /// A place that the modes of a body with large ones move and turn. The shapes are those of the extended coordinates; its axes as
    /// columns, body axes.
    pub fn on_bent(
        body: usize,
        manifold: &Manifold,
        point: &PointShapes,
        turning: &RotationShapes,
        axes_body: Matrix3<f64>,
    ) -> Self {
        let patch = turning.patch().map(|patch| patch.with_modes(manifold.by_coordinates(patch.modes())));
        let displacement = manifold.by_coordinates(&point.columns()[6..]);
        let rotation = match patch {
            Some(_) => vec![Vector3::zeros(); displacement.len()],
            None => manifold.by_coordinates(&turning.columns()[6..]),
        };
        let flexible = Self::on_flexible(body, point, turning, axes_body);
        Self { displacement, rotation, patch, is_bent: true, ..flexible }
    }

    /// The number of its body; `None` on the ground.
    pub fn body(&self) -> Option<usize> {
        self.body
    }

    /// Counts its place on the ground from another one.
    pub(crate) fn count_from(&mut self, anchor: Vector3<f64>) {
        self.anchor = anchor;
    }

    /// Its distance from the origin of its body, where that is not deformed, or from the global one.
    pub(crate) fn distance(&self) -> f64 {
        self.position.norm()
    }

    /// Its place on its undeformed body, from the origin; on the ground, global.
    pub(crate) fn position(&self) -> Vector3<f64> {
        self.position
    }

    /// True if the modes move and turn it as another on the same body.
    pub fn moves_as(&self, other: &Self) -> bool {
        self.position == other.position
            && self.displacement == other.displacement
            && self.rotation == other.rotation
            && self.patch.as_ref().map(PatchTurn::modes) == other.patch.as_ref().map(PatchTurn::modes)
    }

    /// Number of coordinates that move it.
    pub(crate) fn coordinates(&self) -> usize {
        self.displacement.len()
    }

    /// True if these are those of a manifold.
    pub(crate) fn is_bent(&self) -> bool {
        self.is_bent
    }

    /// The least number of modes that a displacement of second order knows.
    pub(crate) fn least_of_second_order(&self) -> Option<usize> {
        self.second_order.iter().flatten().map(SecondOrder::modes).min()
    }

    /// The marker where its body is, in the frame of that; of the ground, from its anchor.
    pub(crate) fn place(&self, body: Option<&BodyPlace<'_>>) -> MarkerPlace {
        let Some(body) = body else {
            return MarkerPlace {
                position: self.position - self.anchor,
                axes: self.axes,
                arm: Vector3::zeros(),
                body_from_global: Matrix3::identity(),
                tangent: Matrix3::identity(),
                patch: None,
            };
        };
        let BodyPlace { origin, body_from_global, q, .. } = body;
        let global_from_body = body_from_global.transpose();
        if self.displacement.is_empty() {
            return MarkerPlace {
                position: origin + global_from_body * self.position,
                axes: global_from_body * self.axes,
                arm: self.position,
                body_from_global: *body_from_global,
                tangent: Matrix3::identity(),
                patch: None,
            };
        }
        let (mut arm, mut theta) = (self.position, Vector3::zeros());
        for ((psi, turn), x) in self.displacement.iter().zip(&self.rotation).zip(body.coordinates()) {
            arm += psi * *x;
            theta += turn * *x;
        }
        for (sum, second_order) in [&mut arm, &mut theta].into_iter().zip(&self.second_order) {
            *sum += second_order.as_ref().map_or_else(Vector3::zeros, |of| of.displacement(q));
        }
        let turned = transformation_matrix(&-theta);
        let patch = self.patch.as_ref().map(|patch| {
            // What is torn flat has no turn: steps fail there.
            let fit = patch.fit(body.coordinates().iter().copied()).unwrap_or(PatchFit::NONE);
            TurnedPatch { fit, turned }
        });
        let of_patch = patch.map_or(turned, |patch| turned * patch.fit.rotation);
        MarkerPlace {
            position: origin + global_from_body * arm,
            axes: global_from_body * of_patch * self.axes,
            arm,
            body_from_global: *body_from_global,
            tangent: tangent_of(&theta),
            patch,
        }
    }

    /// The motion of the marker, by its place, that of its body, and the velocities of it: V and ω in body axes, q̇.
    pub(crate) fn motion(&self, place: &MarkerPlace, body: Option<&BodyPlace<'_>>, velocities: &[f64]) -> MarkerMotion {
        let (mut velocity, mut omega) = (Vector3::zeros(), Vector3::zeros());
        if let (Some(body), v @ [_, _, _, _, _, _, rates @ ..]) = (body, velocities) {
            let [of_origin, spin] = [0, 3].map(|first| Vector3::new(v[first], v[first + 1], v[first + 2]));
            (velocity, omega) = (of_origin + spin.cross(&place.arm), Vector3::zeros());
            for ((psi, turn), rate) in self.displacement.iter().zip(&self.rotation).zip(body.rates(rates)) {
                velocity += psi * rate;
                omega += turn * rate;
            }
            for (sum, second_order) in [&mut velocity, &mut omega].into_iter().zip(&self.second_order) {
                *sum += second_order.as_ref().map_or_else(Vector3::zeros, |of| of.velocity(body.q, rates));
            }
            omega = spin + place.tangent * omega;
            if let (Some(patch), Some(TurnedPatch { fit, turned })) = (&self.patch, &place.patch) {
                omega += turned * patch.spin_at(fit, body.rates(rates));
            }
        }
        MarkerMotion {
            position_global: place.position,
            axes_global: place.axes,
            velocity_global: place.body_from_global.tr_mul(&velocity),
            omega_global: place.body_from_global.tr_mul(&omega),
        }
    }

    /// Adds a force and a moment (global, at the marker) to generalised forces of its body, where that is: force, moment about the
    /// origin, both in body axes, modal forces.
    pub(crate) fn add_wrench(
        &self,
        place: &MarkerPlace,
        body: &BodyPlace<'_>,
        [force, moment]: [&Vector3<f64>; 2],
        generalised: &mut [f64],
    ) {
        let [force_body, moment_body] = [force, moment].map(|vector| place.body_from_global * vector);
        let about_origin = place.arm.cross(&force_body) + moment_body;
        for i in 0..3 {
            generalised[i] += force_body[i];
            generalised[3 + i] += about_origin[i];
        }
        let modal = &mut generalised[6..];
        let turning = place.tangent.tr_mul(&moment_body);
        let along = |(psi, turn): (&Vector3<f64>, &Vector3<f64>)| psi.dot(&force_body) + turn.dot(&turning);
        body.add_forces(self.displacement.iter().zip(&self.rotation).map(along), modal);
        if let (Some(patch), Some(TurnedPatch { fit, turned })) = (&self.patch, &place.patch) {
            body.add_forces(patch.forces_at(fit, &turned.tr_mul(&moment_body)), modal);
        }
        for (vector, second_order) in [&force_body, &turning].into_iter().zip(&self.second_order) {
            if let Some(second_order) = second_order {
                second_order.add_force(vector, body.q, modal);
            }
        }
    }
}

/// The position of a body: its origin, its attitude, its modal displacements, and with large modes the place on their manifold.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BodyPlace<'a> {
    pub origin: Vector3<f64>,
    pub body_from_global: Matrix3<f64>,
    pub q: &'a [f64],
    pub bent: Option<BentPlace<'a>>,
}

impl<'a> BodyPlace<'a> {
    /// The coordinates that move markers: q or z.
    fn coordinates(&self) -> &'a [f64] {
        self.bent.map_or(self.q, |bent| bent.z)
    }

    /// Their rates at modal velocities.
    fn rates(&self, modal: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        let of_products = self.bent.map(|BentPlace { manifold, point, .. }| manifold.rates_of_products(point, modal));
        modal.iter().copied().chain(of_products.into_iter().flatten())
    }

    /// Adds the modal forces of forces on the coordinates.
    fn add_forces(&self, mut forces: impl Iterator<Item = f64>, modal: &mut [f64]) {
        modal.iter_mut().zip(forces.by_ref()).for_each(|(sum, force)| *sum += force);
        if let Some(BentPlace { manifold, point, .. }) = self.bent {
            manifold.add_forces_of_products(point, forces, modal);
        }
    }
}

/// A marker where its body is.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MarkerPlace {
    /// Global.
    pub position: Vector3<f64>,
    /// Columns, global.
    pub axes: Matrix3<f64>,
    /// From the origin of the body, body axes.
    pub arm: Vector3<f64>,
    body_from_global: Matrix3<f64>,
    /// T: the angular velocity of the marker in the body is T Θ q̇.
    tangent: Matrix3<f64>,
    patch: Option<TurnedPatch>,
}

/// A patch that large modes have turned, and the small rotation that it is turned by after that.
#[derive(Debug, Clone, Copy)]
struct TurnedPatch {
    fit: PatchFit,
    turned: Matrix3<f64>,
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
    use crate::conservative::manifold::in_joints::tests::{noise, sample};

    /// Along each axis another symmetric matrix.
    fn second_order(modes: usize, size: f64) -> SecondOrder {
        let of = |axis: usize| {
            let entry = |i: usize, j: usize| size * (1.0 + axis as f64 + (i * j) as f64 - 0.5 * (i + j) as f64);
            (Vector3::ith(axis, 1.0), faer::Mat::from_fn(modes, modes, entry))
        };
        SecondOrder::new((0..3).map(of).collect()).unwrap()
    }

    fn shapes(count: usize, seed: f64) -> Vec<Vector3<f64>> {
        (0..count).map(|k| Vector3::new(0.1, -0.2, 0.3) * (seed + f64::from(k as u32))).collect()
    }

    /// Independent reference: central differences of the place: the virtual work of a force and a moment is that of
    /// their generalised forces, and a motion has the power of the forces in it.
    fn check_work(marker: &Marker, manifold: Option<&Manifold>, q: &[f64]) {
        let start = transformation_matrix(&Vector3::new(0.2, -0.5, 0.3));
        let at = |delta: f64, direction: usize, then: &mut dyn FnMut(&BodyPlace<'_>)| {
            let mut q = q.to_vec();
            let (mut origin, mut theta) = (Vector3::new(1.0, 2.0, 3.0), Vector3::zeros());
            match direction {
                // Along the axes of the body.
                0..3 => origin += start.row(direction).transpose() * delta,
                3..6 => theta[direction - 3] += delta,
                _ => q[direction - 6] += delta,
            }
            let body_from_global = transformation_matrix(&theta) * start;
            let mut z = vec![0.0; manifold.map_or(0, Manifold::size)];
            let point = manifold.map(|manifold| {
                let mut point = manifold.place();
                manifold.go_to(&q, &mut point, &mut z);
                (manifold, point)
            });
            let bent = point.as_ref().map(|(manifold, point)| BentPlace { manifold, point, z: &z });
            then(&BodyPlace { origin, body_from_global, q: &q, bent });
        };
        let placed = |delta: f64, direction: usize| {
            let mut found = None;
            at(delta, direction, &mut |body| found = Some(marker.place(Some(body))));
            found.unwrap()
        };
        let [force, moment] = [Vector3::new(1.0, -2.0, 0.5), Vector3::new(0.3, 0.7, -1.1)];
        let velocities: Vec<f64> = (0..6 + q.len()).map(|k| (k as f64 * 1.7).sin()).collect();
        let mut generalised = vec![0.0; 6 + q.len()];
        let mut power = 0.0;
        at(0.0, 0, &mut |body| {
            let place = marker.place(Some(body));
            marker.add_wrench(&place, body, [&force, &moment], &mut generalised);
            let motion = marker.motion(&place, Some(body), &velocities);
            power = force.dot(&motion.velocity_global) + moment.dot(&motion.omega_global);
        });
        let of_velocities: f64 = generalised.iter().zip(&velocities).map(|(force, velocity)| force * velocity).sum();
        assert!((power - of_velocities).abs() < 1e-13, "{power} {of_velocities}");
        let delta = 1e-5;
        for (direction, found) in generalised.into_iter().enumerate() {
            let [back, ahead] = [placed(-delta, direction), placed(delta, direction)];
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
        // The first order of both.
        let mut change = faer::Mat::zeros(6 + q.len(), 6 + q.len());
        at(0.0, 0, &mut |body| {
            let tangent = marker.tangent(body, q.len(), [&Vector3::zeros(); 2]);
            tangent.add_force_change([&force, &moment], &mut change);
            let place = marker.place(Some(body));
            let motion = marker.motion(&place, Some(body), &velocities);
            let by_tangent = |row: usize| (0..velocities.len()).map(|k| tangent.motion[(row, k)] * velocities[k]).sum();
            let [velocity, omega] = [0, 3].map(|first| Vector3::from_fn(|i, _| by_tangent(first + i)));
            assert!((velocity - motion.velocity_global).norm() < 1e-13, "{velocity} {}", motion.velocity_global);
            assert!((omega - motion.omega_global).norm() < 1e-13, "{omega} {}", motion.omega_global);
        });
        let forces = |delta: f64, direction: usize| {
            let mut generalised = vec![0.0; 6 + q.len()];
            at(delta, direction, &mut |body| {
                marker.add_wrench(&marker.place(Some(body)), body, [&force, &moment], &mut generalised);
            });
            generalised
        };
        for direction in 0..6 + q.len() {
            let [back, ahead] = [forces(-delta, direction), forces(delta, direction)];
            for row in 0..6 + q.len() {
                let expected = (ahead[row] - back[row]) / (2.0 * delta);
                let found = change[(row, direction)];
                assert!((expected - found).abs() < 1e-8, "{row} by {direction}: {found} {expected}");
            }
        }
    }

    #[test]
    fn generalised_forces_do_the_work_of_their_wrench() {
        let marker = Marker {
            displacement: shapes(3, 0.7),
            rotation: vec![Vector3::x(), Vector3::new(0.3, 1.0, -0.2), Vector3::new(-0.5, 0.1, 0.8)],
            second_order: [0.3, -0.4].map(|size| Some(second_order(3, size))),
            ..Marker::on_rigid(0, Vector3::new(0.4, -0.3, 0.2), Matrix3::identity())
        };
        check_work(&marker, None, &[0.3, -0.2, 0.4]);
    }

    /// With large modes, of a patch that is flat, of one that is not, and of nodes on a line, which has small rotations alone.
    #[test]
    fn so_they_do_on_a_manifold() {
        let manifold = sample();
        let extended = manifold.body().flexible();
        let around = [Vector3::new(1.0, 0.2, 0.0), Vector3::new(-0.7, 0.5, 0.0), Vector3::new(-0.3, -0.7, 0.0)];
        for lift in [Some(0.0), Some(0.4), None] {
            let nodes = lift.map(|lift| [around[0] + Vector3::z() * lift, around[1] - Vector3::z() * lift, around[2]]);
            let patch = nodes.and_then(|nodes| {
                let mode = |k: usize| -> Matrix3<f64> {
                    let shape = |node: usize| Vector3::from_fn(|i, _| 0.3 * noise(9 * k + 3 * node + i));
                    nodes.iter().enumerate().map(|(node, d)| shape(node) * d.transpose()).sum()
                };
                let rest = nodes.iter().map(|d| d * d.transpose()).sum();
                PatchTurn::new(rest, (0..extended).map(mode).collect())
            });
            assert_eq!(patch.is_some(), lift.is_some());
            let is_patch = patch.is_some();
            let small = if is_patch { vec![Vector3::zeros(); extended] } else { shapes(extended, -0.4) };
            let marker = Marker {
                displacement: manifold.by_coordinates(&shapes(extended, 0.7)),
                rotation: manifold.by_coordinates(&small),
                patch: patch.map(|patch| patch.with_modes(manifold.by_coordinates(patch.modes()))),
                is_bent: true,
                second_order: [0.3, -0.4].map(|size| Some(second_order(4, size))),
                ..Marker::on_rigid(0, Vector3::new(0.4, -0.3, 0.2), Matrix3::identity())
            };
            check_work(&marker, Some(&manifold), &[0.3, -0.2, 0.4, 0.1]);
        }
    }
}
