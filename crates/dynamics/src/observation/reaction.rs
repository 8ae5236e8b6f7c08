//! Reaction of the constraints on a body: force and moment, by d'Alembert's principle.
//!
//! ```text
//! F = m a_c − Σ F_k
//! M = J ω' + J' ω + S·ν' + ω × (J ω + S·ν) + m c × a_o − Σ M_k        about the origin o, body axes
//! J = J0 + 2 c_ij·ξ + ξᵀ N_ij ξ − qᵀ K_ij q,   J' = 2 (c_ij + N_ij ξ)·ν − 2 (K_ij q)·q̇,   S_i = b_i + G_i ξ
//! ```
//!
//! c and a_c are the centre of mass and its acceleration, ξ and ν the coordinates of the shapes and their rates. These are the
//! momenta of the motion and their rates about all three axes, with the same terms as in the equations of motion: along what is
//! left free F and M vanish, and what a drive does is along its axis.

use faer::Mat;
use nalgebra::{Matrix3, Vector3};
use reduced_body::ReducedBody;

use crate::body::effect::{Effect, EffectMap};
use crate::body::spin_stiffness::SpinStiffness;
use crate::matrix::blocked_matrix::BlockedMatrix;
use crate::matrix::lists::dot;
use crate::matrix::symmetric;

/// Reaction of the constraints on a body, and place in the motion that they leave. Zero of a free body, and of one that moves
/// by the formulation of the paper.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[non_exhaustive]
pub struct Reaction {
    /// Force on the body, body components.
    pub force_body: Vector3<f64>,
    /// Moment on the body about its origin, body components.
    pub moment_body: Vector3<f64>,
    /// Torque of a driven hinge, or force of a driven slider, on the body along its axis.
    pub drive: f64,
    /// Its power.
    pub drive_power: f64,
    /// Angle that a hinged body has turned by since the beginning, rad; it grows beyond a turn.
    pub hinge_angle: f64,
    /// Its rate.
    pub hinge_rate: f64,
    /// Distance that a sliding body has moved by since the beginning.
    pub slider_position: f64,
    /// Its rate.
    pub slider_velocity: f64,
}

impl Reaction {
    /// All its numbers.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = &f64> {
        let Self {
            force_body,
            moment_body,
            drive,
            drive_power,
            hinge_angle,
            hinge_rate,
            slider_position,
            slider_velocity,
        } = self;
        let scalars = [drive, drive_power, hinge_angle, hinge_rate, slider_position, slider_velocity];
        force_body.iter().chain(moment_body).chain(scalars)
    }
}

/// The constants of the momenta of a body that is held, about all three axes through its origin.
#[derive(Debug, Clone)]
pub(crate) struct Held {
    pub mass: f64,
    pub inertia: Matrix3<f64>,
    /// c_ij (6, or none without terms that follow the deformation).
    pub first: Vec<Vec<f64>>,
    /// N_ij of the same (nf × nf each).
    pub second: Vec<BlockedMatrix>,
    /// K_ij of the modes; none without the stress of the spin.
    pub stress: Vec<BlockedMatrix>,
    /// b_i (nf each).
    pub coupling: [Vec<f64>; 3],
    /// G_i (nf × nf each, or none without Coriolis terms).
    pub gyroscopic: Vec<BlockedMatrix>,
}

/// A motion, body components; ξ, ν and ν' of the shapes of the constants.
#[derive(Debug, Clone, Copy)]
pub(crate) struct HeldMotion<'a> {
    pub omega: Vector3<f64>,
    pub alpha: Vector3<f64>,
    /// Acceleration of the origin.
    pub acceleration: Vector3<f64>,
    /// Position of the centre of mass from the origin, and its acceleration.
    pub center: Vector3<f64>,
    pub center_acceleration: Vector3<f64>,
    pub displacement: &'a [f64],
    pub velocity: &'a [f64],
    pub shape_acceleration: &'a [f64],
    /// q and q̇.
    pub modal_displacement: &'a [f64],
    pub modal_velocity: &'a [f64],
}

impl Held {
    /// Constants of a body in its shapes, stiffened by the stress of its spin; `None` of a free one.
    pub(crate) fn new(
        body: &ReducedBody,
        stiffness: Option<&SpinStiffness>,
        effects: &EffectMap<bool>,
    ) -> Option<Self> {
        if body.motion.is_free() {
            return None;
        }
        let follows = effects[Effect::DeformedInertia] && body.flexible() > 0;
        let matrices = |list: &[Mat<f64>]| list.iter().map(|matrix| BlockedMatrix::new(matrix.as_ref())).collect();
        Some(Self {
            mass: body.mass,
            inertia: body.inertia,
            first: if follows { body.inertia_first.to_vec() } else { Vec::new() },
            second: if follows { matrices(&body.inertia_second) } else { Vec::new() },
            stress: match stiffness {
                Some(stiffness) if follows => matrices(stiffness.of_pairs()),
                _ => Vec::new(),
            },
            coupling: body.rotation_first.clone(),
            gyroscopic: if effects[Effect::Coriolis] { matrices(&body.gyroscopic) } else { Vec::new() },
        })
    }

    /// Rates of the momenta of a motion: that of the linear momentum, and that of the angular momentum about the origin,
    /// both as an observer at rest sees them, body components. It allocates, and is for rows of output only.
    pub(crate) fn momentum_rates(&self, motion: &HeldMotion<'_>) -> [Vector3<f64>; 2] {
        let HeldMotion { omega, alpha, displacement: xi, velocity: nu, shape_acceleration, .. } = *motion;
        let (q, q_rate) = (motion.modal_displacement, motion.modal_velocity);
        let mut product = vec![0.0; xi.len()];
        let (mut inertia, mut inertia_rate) = (self.inertia, Matrix3::zeros());
        for (pair, (first, second)) in ReducedBody::PAIRS.into_iter().zip(self.first.iter().zip(&self.second)) {
            second.multiply(xi, &mut product);
            symmetric::add(&mut inertia, pair, 2.0 * dot(first, xi) + dot(&product, xi));
            symmetric::add(&mut inertia_rate, pair, 2.0 * (dot(first, nu) + dot(&product, nu)));
        }
        for (pair, stress) in ReducedBody::PAIRS.into_iter().zip(&self.stress) {
            let k_q = &mut product[..q.len()];
            stress.multiply(q, k_q);
            symmetric::add(&mut inertia, pair, -dot(k_q, q));
            symmetric::add(&mut inertia_rate, pair, -2.0 * dot(k_q, q_rate));
        }
        let (mut of_shapes, mut rate_of_shapes) = (Vector3::zeros(), Vector3::zeros());
        for (axis, b) in self.coupling.iter().enumerate() {
            product.copy_from_slice(b);
            if let Some(gyroscopic) = self.gyroscopic.get(axis) {
                gyroscopic.add_product(xi, &mut product);
            }
            of_shapes[axis] = dot(&product, nu);
            // G ν does no work on ν.
            rate_of_shapes[axis] = dot(&product, shape_acceleration);
        }
        let momentum = inertia * omega + of_shapes;
        let about_origin = inertia * alpha + inertia_rate * omega + rate_of_shapes + omega.cross(&momentum);
        [motion.center_acceleration * self.mass, about_origin + motion.center.cross(&motion.acceleration) * self.mass]
    }
}
