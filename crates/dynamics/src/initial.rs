//! How a motion begins.

use modal::ReducedBody;
use nalgebra::Vector3;
use rigid_kin::Attitude;

use crate::error::SetupError;

/// State at the beginning.
#[derive(Debug, Clone, PartialEq)]
pub struct Initial {
    /// Attitude of the body frame.
    pub attitude: Attitude,
    /// Velocity of the frame's origin (the centre of mass), global components.
    pub velocity: Vector3<f64>,
    /// Angular velocity of the body frame, body components.
    pub omega: Vector3<f64>,
    /// Flexible modal displacements (nf).
    pub modal_displacement: Vec<f64>,
    /// Rates of the flexible modal displacements as seen from the body frame (nf).
    pub modal_velocity: Vec<f64>,
}

impl Initial {
    /// At rest and undeformed.
    pub fn at_rest(flexible: usize) -> Self {
        Self {
            attitude: Attitude::identity(),
            velocity: Vector3::zeros(),
            omega: Vector3::zeros(),
            modal_displacement: vec![0.0; flexible],
            modal_velocity: vec![0.0; flexible],
        }
    }

    /// Refuses lists of the wrong length and numbers that are not finite.
    pub(crate) fn check(&self, flexible: usize) -> Result<(), SetupError> {
        for (what, list) in [
            ("the list of initial modal displacements", &self.modal_displacement),
            ("the list of initial modal velocities", &self.modal_velocity),
        ] {
            if list.len() != flexible {
                return Err(SetupError::Length { what, expected: flexible, found: list.len() });
            }
        }
        let numbers = self.velocity.iter().chain(self.omega.iter()).chain(&self.modal_displacement);
        match numbers.chain(&self.modal_velocity).copied().find(|x| !x.is_finite()) {
            Some(found) => Err(SetupError::Value { what: "an initial value", found, expected: "a finite number" }),
            None => Ok(()),
        }
    }

    /// Modal displacements and modal velocities (6+nf each) in the inertial frame that coincides with the body.
    ///
    /// The velocity of a particle is `V + ω×(X + u) + Ψ_f q̇`, so `y = y_rigid + G(ω) q + q̇`: (31) of that field.
    pub(crate) fn modal_state(&self, body: &ReducedBody) -> Result<(Vec<f64>, Vec<f64>), SetupError> {
        self.check(body.flexible())?;
        // ω = B y: y = B⁻¹ ω = Bᵀ J₀ ω, since B Bᵀ = J₀⁻¹.
        let rotation = body.rotation_basis.transpose() * body.inertia * self.omega;
        let translation = body.translation_basis.transpose() * self.attitude.to_body(&self.velocity) * body.mass;
        let displacement: Vec<f64> =
            std::iter::repeat_n(0.0, 6).chain(self.modal_displacement.iter().copied()).collect();
        let mut velocity: Vec<f64> =
            translation.iter().chain(rotation.iter()).chain(&self.modal_velocity).copied().collect();
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
}
