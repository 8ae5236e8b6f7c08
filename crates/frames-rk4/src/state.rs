//! The state in the travelling frame.

use dynamics::checkpoint::{CheckpointError, expect, finite};
use dynamics::nalgebra::Vector3;
use dynamics::reduced_body::ReducedBody;
use dynamics::rigid_kin::Attitude;
use dynamics::{Initial, SetupError};
use serde::{Deserialize, Serialize};

/// State at one time, in the inertial frame that coincides with the (dummy) rigid body then.
///
/// Modal lists have 6+nf entries: three translations, three rotations, then the flexible modes. They are components
/// in this frame, of motion relative to global space (η of Eq. 33), not to the body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Time.
    pub time: f64,
    /// Attitude of the frame.
    pub attitude: Attitude,
    /// Where the frame's origin is, global components; at the beginning it is the centre of mass.
    pub origin_global: Vector3<f64>,
    /// Modal displacements q. The rigid ones are the remainder that the frame has not taken.
    pub modal_displacement: Vec<f64>,
    /// Modal velocities q̇.
    pub modal_velocity: Vec<f64>,
    /// Modal accelerations q̈.
    pub modal_acceleration: Vec<f64>,
    /// Angular velocity of the dummy rigid body by g, Eq. (36), body components.
    pub omega_body: Vector3<f64>,
    /// Its angular acceleration by h, Eq. (37), body components. See [`dynamics::rigid_kin::ReferencePoints`] for its
    /// limits.
    pub alpha_body: Vector3<f64>,
}

impl State {
    /// The state at the beginning, its rates still to be found.
    pub(crate) fn begin(body: &ReducedBody, initial: &Initial) -> Result<Self, SetupError> {
        let (modal_displacement, modal_velocity) = modal_state(initial, body)?;
        Ok(Self {
            time: 0.0,
            attitude: initial.attitude,
            origin_global: initial.origin.unwrap_or(body.origin),
            modal_acceleration: vec![0.0; modal_velocity.len()],
            modal_displacement,
            modal_velocity,
            omega_body: Vector3::zeros(),
            alpha_body: Vector3::zeros(),
        })
    }

    /// Takes over another state of the same body, without allocating.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        let Self { time, attitude, origin_global, omega_body, alpha_body, .. } = other;
        (self.time, self.attitude, self.origin_global) = (*time, *attitude, *origin_global);
        (self.omega_body, self.alpha_body) = (*omega_body, *alpha_body);
        self.modal_displacement.copy_from_slice(&other.modal_displacement);
        self.modal_velocity.copy_from_slice(&other.modal_velocity);
        self.modal_acceleration.copy_from_slice(&other.modal_acceleration);
    }

    /// Refuses lists of the wrong length and numbers that are not finite.
    pub(crate) fn check(&self, modes: usize) -> Result<(), CheckpointError> {
        let Self { time, origin_global, modal_displacement, modal_velocity, modal_acceleration, .. } = self;
        let modal = [modal_displacement, modal_velocity, modal_acceleration];
        expect("a list of modes", modal.iter().all(|list| list.len() == modes))?;
        let vectors = [origin_global, &self.omega_body, &self.alpha_body].into_iter().flatten();
        finite("the state", std::iter::once(time).chain(vectors).chain(modal.into_iter().flatten()))
    }
}

/// The three translations of a modal list.
pub(crate) fn translation(modal: &[f64]) -> Vector3<f64> {
    Vector3::new(modal[0], modal[1], modal[2])
}

/// The three rotations of a modal list.
pub(crate) fn rotation(modal: &[f64]) -> Vector3<f64> {
    Vector3::new(modal[3], modal[4], modal[5])
}

/// Modal displacements and modal velocities (6+nf each) in the inertial frame that coincides with the body.
///
/// The velocity of a particle is `V + ω×(X + u) + Ψ_f q̇`, so `y = y_rigid + G(ω) q + q̇`: (31) of that field.
fn modal_state(initial: &Initial, body: &ReducedBody) -> Result<(Vec<f64>, Vec<f64>), SetupError> {
    initial.check(body.flexible())?;
    // ω = B y: y = B⁻¹ ω = Bᵀ J₀ ω, since B Bᵀ = J₀⁻¹.
    let rotation = body.rotation_basis.transpose() * body.inertia * initial.omega;
    let translation = body.translation_basis.transpose() * initial.attitude.to_body(&initial.velocity) * body.mass;
    let displacement: Vec<f64> =
        std::iter::repeat_n(0.0, 6).chain(initial.modal_displacement.iter().copied()).collect();
    let mut velocity: Vec<f64> =
        translation.iter().chain(rotation.iter()).chain(&initial.modal_velocity).copied().collect();
    // As much of ω as the body has the rotations for.
    let spin = (body.rotation_basis * rotation).cross_matrix();
    for (i, y) in velocity.iter_mut().enumerate() {
        for a in 0..3 {
            for b in 0..3 {
                let product = &body.rotation_products[a][b];
                *y += spin[(a, b)] * displacement.iter().enumerate().map(|(j, q)| product[(i, j)] * q).sum::<f64>();
            }
        }
    }
    Ok((displacement, velocity))
}
