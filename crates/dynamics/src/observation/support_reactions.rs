//! Reactions of each of several supports, by the principle of virtual work.
//!
//! ```text
//! R_c = ψ_cᵀ (M a − f),   a = a_o + α×x + ω×(ω×x) + 2ω×(Ψ ν) + Ψ ν',   x = X + Ψ ξ
//! ```
//!
//! ψ_c is the displacement of the body when support c moves by 1 and the others do not, in static balance: on it the elastic
//! forces do no work, whatever the modes leave out. The stiffness that ψ_c is found with is that of the body at rest: how the
//! stress of loads and spin would share out forces between the supports is not in it. The sum of the forces is the reaction of
//! all supports.

use std::sync::Arc;

use nalgebra::{Matrix3, Vector3};
use reduced_body::ReducedBody;

use crate::body::effect::{Effect, EffectMap};
use crate::conservative::manifold::Manifold;
use crate::load::{Applied, Coordinates, Kinematics, SharedLoad};
use crate::observation::Observation;

/// The constants that the reactions of supports need, Eq. (H3) of `docs/method/constraints.md`.
#[derive(Debug, Clone)]
pub struct SupportReactions(Arc<Constants>);

#[derive(Debug)]
struct Constants {
    shapes: usize,
    motions: Vec<SupportMotion>,
    /// In the coordinates of the shapes and then of the motions.
    loads: Vec<SharedLoad>,
    manifold: Option<Manifold>,
    follows: bool,
    coriolis: bool,
}

/// A motion ψ of a support.
#[derive(Debug)]
struct SupportMotion {
    /// ψᵀ M (1⊗e_i).
    translation: Vector3<f64>,
    /// ψᵀ M (I⊗e_a e_bᵀ) X, in row a and column b.
    position: Matrix3<f64>,
    /// ψᵀ M (I⊗e_a e_bᵀ) φ_k of each shape.
    of_shapes: Vec<Matrix3<f64>>,
}

impl SupportReactions {
    /// Reactions on `body`, whose first `shapes` shapes are those of the motion and whose others are motions of the supports. The loads
    /// are in its modes; with large modes there is their manifold.
    pub fn new(
        body: &ReducedBody,
        shapes: usize,
        loads: Vec<SharedLoad>,
        manifold: Option<Manifold>,
        effects: &EffectMap<bool>,
    ) -> Self {
        let motion = |c: usize| {
            let product = |a: usize, b: usize, k: usize| body.rotation_products[a][b][(6 + c, 6 + k)];
            SupportMotion {
                translation: Vector3::from_fn(|i, _| body.translation_first[i][c]),
                position: Matrix3::from_fn(|a, b| body.position_products[a][b][6 + c]),
                of_shapes: (0..shapes).map(|k| Matrix3::from_fn(|a, b| product(a, b, k))).collect(),
            }
        };
        Self(Arc::new(Constants {
            shapes,
            motions: (shapes..body.flexible()).map(motion).collect(),
            loads,
            manifold,
            follows: effects[Effect::DeformedInertia],
            coriolis: effects[Effect::Coriolis],
        }))
    }

    /// The force or moment along each motion of the supports, body axes. It allocates, and is for rows of output only. Loads see
    /// a body whose origin is at rest.
    pub fn at(&self, now: &Observation) -> Vec<f64> {
        let Constants { shapes, motions, manifold, follows, coriolis, .. } = &*self.0;
        let (q, rate) = (&now.modal_displacement, &now.modal_velocity);
        let [mut xi, mut nu, mut change] = [(); 3].map(|()| vec![0.0; *shapes]);
        match manifold {
            Some(manifold) => {
                let mut place = manifold.place();
                let [mut z, mut z_rate, mut z_change] = [(); 3].map(|()| vec![0.0; manifold.size()]);
                manifold.go(q, &mut place, &mut z);
                manifold.go_along(rate, &mut place, &mut z_rate);
                manifold.extend(&place, &now.modal_acceleration, &mut z_change);
                manifold.add_curvature(&place, &mut z_change);
                for (of_z, of_shapes) in [(z, &mut xi), (z_rate, &mut nu), (z_change, &mut change)] {
                    manifold.in_shapes(&of_z, of_shapes);
                }
            }
            None => {
                xi.copy_from_slice(q);
                nu.copy_from_slice(rate);
                change.copy_from_slice(&now.modal_acceleration);
            }
        }
        let forces = self.load_forces(now, &xi, &nu);
        let omega = now.omega_body.cross_matrix();
        let turning = now.alpha_body.cross_matrix() + omega * omega;
        let acceleration = now.attitude.to_body(&now.origin_acceleration_global);
        let along = |motion: &SupportMotion| {
            let sum = |coordinates: &[f64]| -> Matrix3<f64> {
                motion.of_shapes.iter().zip(coordinates).map(|(product, x)| product * *x).sum()
            };
            let place = if *follows { motion.position + sum(&xi) } else { motion.position };
            let coriolis = if *coriolis { 2.0 * omega.dot(&sum(&nu)) } else { 0.0 };
            motion.translation.dot(&acceleration) + turning.dot(&place) + coriolis + sum(&change).trace()
        };
        motions.iter().zip(forces).map(|(motion, force)| along(motion) - force).collect()
    }

    /// Work of the loads along each motion.
    fn load_forces(&self, now: &Observation, xi: &[f64], nu: &[f64]) -> Vec<f64> {
        let Constants { shapes, motions, loads, manifold, .. } = &*self.0;
        let all = |of_shapes: &[f64]| {
            let mut all = of_shapes.to_vec();
            all.resize(shapes + motions.len(), 0.0);
            all
        };
        let [displacement, velocity] = [xi, nu].map(all);
        let on_manifold = manifold.as_ref().map(|_| [&now.modal_displacement[..], &now.modal_velocity]);
        let coordinates = Coordinates { first: 6, displacement: &displacement, velocity: &velocity, on_manifold };
        let motion = Kinematics {
            time: now.time,
            branch_time: now.time,
            body_from_global: &now.attitude.global_to_body(),
            origin_global: now.origin_global,
            frame_origin_global: now.origin_global,
            origin_velocity_global: Vector3::zeros(),
            omega_body: now.omega_body,
            coordinates,
            unit: false,
        };
        let mut modal = all(&[]);
        let mut applied = Applied::new(coordinates, Vector3::zeros(), &mut modal);
        loads.iter().for_each(|load| load.apply(&motion, &mut applied));
        modal.split_off(*shapes)
    }
}
