//! The factors that the steps of a system need.

use nalgebra::Complex;

use crate::conservative::ConservativeBody;
use crate::system::description::System;
use crate::system::elimination::inverse::Inverse;
use crate::system::elimination::joint_matrix::{JointMatrix, Pattern};
use crate::system::stage::Stage;

/// Factors of a step.
#[derive(Debug, Clone)]
pub(in crate::system) struct Matrices {
    pub is_left_out: Vec<bool>,
    pub mass: Vec<Inverse<f64>>,
    pub real: Vec<Inverse<f64>>,
    pub complex: Vec<Inverse<Complex<f64>>>,
    pub of_mass: JointMatrix<f64>,
    pub of_real: JointMatrix<f64>,
    pub of_complex: JointMatrix<Complex<f64>>,
}

impl Matrices {
    /// Factors of G M⁻¹ Gᵀ, and of the Newton matrix of a real κ, where a stage is. False where an inertia is singular.
    pub fn factor_real(&mut self, system: &System, pattern: &Pattern, stage: &Stage, kappa: f64) -> bool {
        let Self { is_left_out, mass, real, of_mass, of_real, .. } = self;
        for (b, body) in system.bodies.iter().enumerate() {
            let inertia = &stage.inertia[b];
            let is_regular = mass[b].find(1.0, inertia, oscillators(body).map(|_| [0.0; 2]))
                && real[b].find(kappa, inertia, oscillators(body));
            if !is_regular {
                return false;
            }
        }
        of_mass.assemble(pattern, &stage.constraints, mass);
        of_mass.factor(pattern, is_left_out, true);
        of_real.assemble(pattern, &stage.constraints, real);
        of_real.factor(pattern, is_left_out, false);
        true
    }
}

/// Λ_k and D_k of each mode.
pub(in crate::system) fn oscillators(body: &ConservativeBody) -> impl Iterator<Item = [f64; 2]> {
    body.circular_frequencies.iter().zip(&body.damping_ratios).map(|(omega, zeta)| [omega * omega, 2.0 * zeta * omega])
}
