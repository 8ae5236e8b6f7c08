//! The first order of a marker about where its body is: how its motion, and the generalised forces of its wrench, change with
//! the place and the velocities of the body.
//!
//! Eqs. (L3) and (L4) of `docs/method/systems.md`. Changes of place are ρ and φ in body axes, and δq; those of velocities are of V
//! and ω in body axes, and of q̇. The body is in steady motion, q̇ = 0.

use faer::{Mat, MatMut};
use nalgebra::{Matrix3, Vector3};
use rigid_kin::cross_matrix;

use crate::body::patch_turn::{PatchFit, PatchSlope, PatchTurn};
use crate::body::second_order::SecondOrder;
use crate::conservative::manifold::BentShape;
use crate::system::marker::{BodyPlace, Marker};

/// A marker where its body is, with its first order.
#[derive(Debug, Clone)]
pub(crate) struct MarkerTangent {
    /// Displacement and turn (global) of the marker by the changes of place, and its velocity and angular velocity by those of the
    /// velocities (6×n).
    pub motion: Mat<f64>,
    /// Velocity and angular velocity by the changes of place, at the same velocities (6×n).
    pub velocity: Mat<f64>,
    body_from_global: Matrix3<f64>,
    arm: Vector3<f64>,
    /// Rotation vector of the modes.
    theta: Vector3<f64>,
    /// T(θ).
    tangent: Matrix3<f64>,
    /// Columns of ∂s/∂q and ∂θ/∂q.
    arm_slopes: Vec<Vector3<f64>>,
    turn_slopes: Vec<Vector3<f64>>,
    second_order: [Option<SecondOrder>; 2],
    bent: Option<BentTangent>,
}

/// The part of large modes in the first order of a marker.
#[derive(Debug, Clone)]
struct BentTangent {
    shape: BentShape,
    /// Columns of Ψ and Θ by z.
    displacement: Vec<Vector3<f64>>,
    rotation: Vec<Vector3<f64>>,
    patch: Option<PatchTangent>,
}

/// Effects of large modes on a patch.
#[derive(Debug, Clone)]
struct PatchTangent {
    turn: PatchTurn,
    fit: PatchFit,
    slopes: Vec<PatchSlope>,
    /// By the small rotation θ after R.
    turned: Matrix3<f64>,
}

impl Marker {
    /// Its first order where its body is, with `modes` modes and the velocities V and ω in body axes.
    pub(crate) fn tangent(
        &self,
        body: &BodyPlace<'_>,
        modes: usize,
        [velocity, omega]: [&Vector3<f64>; 2],
    ) -> MarkerTangent {
        let BodyPlace { body_from_global, q, .. } = body;
        let place = self.place(Some(body));
        let shape = body.bent.map(|bent| bent.slopes());
        let slopes = |columns: &[Vector3<f64>], second_order: Option<&SecondOrder>| {
            let mut slopes = match &shape {
                Some(shape) => shape.iter().map(|along| columns.iter().zip(along).map(|(c, x)| c * *x).sum()).collect(),
                None => columns.to_vec(),
            };
            slopes.resize(modes, Vector3::zeros());
            if let Some(second_order) = second_order {
                second_order.add_slopes(q, &mut slopes);
            }
            slopes
        };
        let [of_place, of_turn] = self.second_order.each_ref().map(Option::as_ref);
        let (arm_slopes, turn_slopes) = (slopes(&self.displacement, of_place), slopes(&self.rotation, of_turn));
        let linear: Vector3<f64> = self.rotation.iter().zip(body.coordinates()).map(|(turn, x)| turn * *x).sum();
        let theta = linear + of_turn.map_or_else(Vector3::zeros, |of| of.displacement(q));
        let patch = self.patch.as_ref().zip(place.patch).zip(shape.as_ref()).map(|((turn, of), shape)| PatchTangent {
            slopes: shape.iter().map(|along| turn.slope_at(&of.fit, along.iter().copied())).collect(),
            turn: turn.clone(),
            fit: of.fit,
            turned: of.turned,
        });
        let global_from_body = body_from_global.transpose();
        let n = 6 + modes;
        let (mut motion, mut of_velocity) = (Mat::zeros(6, n), Mat::zeros(6, n));
        let set = |matrix: &mut Mat<f64>, column: usize, halves: [Vector3<f64>; 2]| {
            for (first, half) in [0, 3].into_iter().zip(halves) {
                let half = global_from_body * half;
                (0..3).for_each(|i| matrix[(first + i, column)] = half[i]);
            }
        };
        let speed = velocity + omega.cross(&place.arm);
        for k in 0..3 {
            let unit = Vector3::ith(k, 1.0);
            set(&mut motion, k, [unit, Vector3::zeros()]);
            set(&mut motion, 3 + k, [unit.cross(&place.arm), unit]);
            set(&mut of_velocity, 3 + k, [unit.cross(&speed), unit.cross(omega)]);
        }
        for (k, (slope, turn)) in arm_slopes.iter().zip(&turn_slopes).enumerate() {
            let of_patch = patch.as_ref().map_or_else(Vector3::zeros, |patch| patch.spin(k));
            set(&mut motion, 6 + k, [*slope, place.tangent * turn + of_patch]);
            set(&mut of_velocity, 6 + k, [omega.cross(slope), Vector3::zeros()]);
        }
        MarkerTangent {
            motion,
            velocity: of_velocity,
            body_from_global: *body_from_global,
            arm: place.arm,
            theta,
            tangent: place.tangent,
            arm_slopes,
            turn_slopes,
            second_order: self.second_order.clone(),
            bent: body.bent.map(|bent| BentTangent {
                shape: bent.to_shape(),
                displacement: self.displacement.clone(),
                rotation: self.rotation.clone(),
                patch,
            }),
        }
    }
}

impl MarkerTangent {
    /// Adds the change of the generalised forces of a force and a moment (global, at the marker), which stay as they are, by the
    /// changes of place (n×n).
    pub fn add_force_change(&self, [force, moment]: [&Vector3<f64>; 2], to: &mut Mat<f64>) {
        let [f, t] = [force, moment].map(|vector| self.body_from_global * vector);
        let [f_cross, t_cross, arm_cross] = [&f, &t, &self.arm].map(cross_matrix);
        let about_origin = arm_cross * f_cross + t_cross;
        for (i, j) in (0..3).flat_map(|j| (0..3).map(move |i| (i, j))) {
            to[(i, 3 + j)] += f_cross[(i, j)];
            to[(3 + i, 3 + j)] += about_origin[(i, j)];
        }
        let turning = self.tangent.tr_mul(&t);
        let of_turn = turned_back_change(&self.theta, &t);
        for (k, (slope, turn)) in self.arm_slopes.iter().zip(&self.turn_slopes).enumerate() {
            let moved = slope.cross(&f);
            let of_patch = self.patch().map_or_else(Vector3::zeros, |patch| patch.spin(k));
            let by_rotation = f_cross.tr_mul(slope) + t_cross.tr_mul(&(self.tangent * turn + of_patch));
            for i in 0..3 {
                to[(3 + i, 6 + k)] += moved[i];
                to[(6 + k, 3 + i)] += by_rotation[i];
            }
        }
        if of_turn != Matrix3::zeros() {
            for (j, by) in self.turn_slopes.iter().enumerate() {
                let change = of_turn * by;
                self.turn_slopes.iter().enumerate().for_each(|(i, turn)| to[(6 + i, 6 + j)] += turn.dot(&change));
            }
        }
        let modes = to.nrows() - 6;
        if let Some(bent) = &self.bent {
            let change = bent.force_change([&f, &t], &turning, (&self.tangent, &self.turn_slopes));
            for (i, j) in (0..modes).flat_map(|j| (0..modes).map(move |i| (i, j))) {
                to[(6 + i, 6 + j)] += change[(i, j)];
            }
        }
        self.add_stress(-1.0, [&f, &turning], to.submatrix_mut(6, 6, modes, modes));
    }

    fn patch(&self) -> Option<&PatchTangent> {
        self.bent.as_ref()?.patch.as_ref()
    }

    /// Adds the stiffness of the modes by a force and a moment (global, at the marker), that of their stress: f_i K_i + t_i K'_i
    /// (nf×nf).
    pub fn add_stiffening(&self, [force, moment]: [&Vector3<f64>; 2], to: &mut Mat<f64>) {
        let [f, t] = [force, moment].map(|vector| self.body_from_global * vector);
        self.add_stress(1.0, [&f, &self.tangent.tr_mul(&t)], to.as_mut());
    }

    /// Adds so much of f_i K_i + t_i K'_i, of a force and a turning moment in body axes (nf×nf).
    fn add_stress(&self, factor: f64, wrench: [&Vector3<f64>; 2], mut to: MatMut<'_, f64>) {
        for (second_order, vector) in self.second_order.iter().zip(wrench) {
            if let Some(second_order) = second_order {
                second_order.add_stiffness(factor, vector, to.as_mut());
            }
        }
    }
}

impl BentTangent {
    /// The change by δq of the modal forces of a force and a moment in body axes, of the moment also as T(θ)ᵀ turns it: by the curvature of
    /// the manifold, and by the turn of the patch (modes × modes).
    fn force_change(
        &self,
        [force, moment]: [&Vector3<f64>; 2],
        turning: &Vector3<f64>,
        (tangent, turn_slopes): (&Matrix3<f64>, &[Vector3<f64>]),
    ) -> Mat<f64> {
        let shape = self.shape.place();
        let on_coordinates =
            self.displacement.iter().zip(&self.rotation).map(|(psi, turn)| psi.dot(force) + turn.dot(turning));
        let mut change = shape.curvature(on_coordinates);
        if let Some(patch) = &self.patch {
            let back = patch.turned.tr_mul(moment);
            change += shape.curvature(patch.turn.forces_at(&patch.fit, &back));
            let in_patch = patch.fit.rotation.tr_mul(&back);
            for (j, by) in patch.slopes.iter().enumerate() {
                let turned_by = tangent * turn_slopes[j];
                for (i, of) in patch.slopes.iter().enumerate() {
                    let spin = by.spin.cross(&of.spin) + patch.fit.spin_change(of, by);
                    change[(i, j)] += in_patch.dot(&spin) + moment.dot(&turned_by.cross(&patch.spin(i)));
                }
            }
        }
        change
    }
}

impl PatchTangent {
    /// Its angular velocity by that of a mode, body axes.
    fn spin(&self, mode: usize) -> Vector3<f64> {
        self.turned * (self.fit.rotation * self.slopes[mode].spin)
    }
}

/// ∂(T(θ)ᵀ t)/∂θ, where Tᵀt = t − a θ×t + b θ×(θ×t).
fn turned_back_change(theta: &Vector3<f64>, t: &Vector3<f64>) -> Matrix3<f64> {
    let square = theta.norm_squared();
    let angle = square.sqrt();
    // a = (1 − cos)/angle², b = (angle − sin)/angle³, and their slopes over the angle, divided by it.
    let (a, b, a_slope, b_slope) = if angle < 0.1 {
        (
            0.5 - square / 24.0 * (1.0 - square / 30.0 * (1.0 - square / 56.0)),
            1.0 / 6.0 - square / 120.0 * (1.0 - square / 42.0 * (1.0 - square / 72.0)),
            -1.0 / 12.0 + square / 180.0 * (1.0 - square / 37.333_333_333_333_336 * (1.0 - square / 67.5)),
            -1.0 / 60.0 + square / 1260.0 * (1.0 - square / 48.0 * (1.0 - square / 82.5)),
        )
    } else {
        let (sine, cosine) = angle.sin_cos();
        let (a, b) = ((1.0 - cosine) / square, (angle - sine) / (square * angle));
        (a, b, (sine / angle - 2.0 * a) / square, ((1.0 - cosine) / square - 3.0 * b) / square)
    };
    let [theta_cross, t_cross] = [theta, t].map(cross_matrix);
    let (once, twice) = (theta.cross(t), theta.cross(&theta.cross(t)));
    // δθ×t = −t×δθ; δθ×(θ×t) = −(θ×t)×δθ; θ×(δθ×t) = −θ×(t×δθ).
    t_cross * a - once * theta.transpose() * a_slope - (cross_matrix(&once) + theta_cross * t_cross) * b
        + twice * theta.transpose() * b_slope
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Independent reference: central differences.
    #[test]
    fn the_change_of_a_moment_on_the_modes_is_that_of_differences() {
        let t = Vector3::new(0.3, -1.2, 0.7);
        let back = |theta: &Vector3<f64>| crate::system::marker::tangent_of(theta).tr_mul(&t);
        for size in [0.0, 0.004, 0.03, 0.099, 0.101, 1.3] {
            let theta = Vector3::new(0.4, 0.5, -0.76).normalize() * size;
            let found = turned_back_change(&theta, &t);
            for k in 0..3 {
                let step = Vector3::ith(k, 1e-5);
                let expected = (back(&(theta + step)) - back(&(theta - step))) / 2e-5;
                let off = (found.column(k) - expected).norm();
                assert!(off < 1e-9, "{size} {k}: {off}");
            }
        }
    }
}
