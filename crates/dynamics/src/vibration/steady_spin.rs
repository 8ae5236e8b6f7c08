//! Small vibrations of a body whose spin is held: what a Campbell diagram shows.
//!
//! ```text
//! q̈ + 2Ω G_a q̇ + (Λ − Ω² (N_aa − K_aa)) q = Ω² c_aa
//! ```
//!
//! G_a, N_aa and K_aa are those of the spin axis a (see [`reduced_body::ReducedBody`]). It is the conservative form with ω = Ω a
//! given, without damping, about the undeformed body.

use faer::{Mat, Scale, Side, c64};
use nalgebra::Vector3;
use reduced_body::ReducedBody;

use crate::body::effect::{Effect, EffectMap};
use crate::body::spin_stiffness::SpinStiffness;
use crate::conservative::InCoordinates;
use crate::vibration::system::error::SteadyError;
use crate::vibration::system::linearization::Linearization;
use crate::vibration::system::spin_mode::SpinMode;

/// The constants of the vibrations of a body that spins about an axis.
#[derive(Debug, Clone)]
pub struct SteadySpin {
    circular_frequencies: Vec<f64>,
    /// G_a (nf×nf); zero without Coriolis terms.
    gyroscopic: Mat<f64>,
    /// N_aa − K_aa (nf×nf); each part zero where its effect is off.
    softening: Mat<f64>,
}

impl SteadySpin {
    /// Spin about `axis`, a unit vector in body axes, with the effects that are on.
    pub fn new(body: &ReducedBody, axis: &Vector3<f64>, effects: &EffectMap<bool>) -> Self {
        let nf = body.flexible();
        let constants = InCoordinates { body, manifold: None };
        let stiffness = body.stress_stiffness.as_ref().filter(|_| effects[Effect::GeometricStiffening]);
        let stiffness = stiffness.map(|stiffness| SpinStiffness::new(stiffness, None));
        let softening = if effects[Effect::DeformedInertia] {
            constants.inertia_second(&ReducedBody::pair_weights([axis, axis]), stiffness.as_ref())
        } else {
            Mat::zeros(nf, nf)
        };
        let gyroscopic = if effects[Effect::Coriolis] { constants.gyroscopic(axis) } else { Mat::zeros(nf, nf) };
        Self { circular_frequencies: body.circular_frequencies.clone(), gyroscopic, softening }
    }

    /// The vibrations at a spin speed in rad per time, slowest first.
    ///
    /// # Errors
    /// [`SteadyError::Numbers`] for numbers that are not finite.
    pub fn modes(&self, speed: f64) -> Result<Vec<SpinMode>, SteadyError> {
        let linear = Linearization::of_modes(
            &self.circular_frequencies,
            &self.softening * Scale(-speed * speed),
            &self.gyroscopic * Scale(2.0 * speed),
        );
        linear.spin_modes(speed)
    }

    /// The spin speed at which Λ − Ω² (N_aa − K_aa) loses definiteness; infinite where it never does.
    ///
    /// # Errors
    /// [`SteadyError::Numbers`] for numbers that are not finite.
    pub fn critical_speed(&self) -> Result<f64, SteadyError> {
        Ok(self.critical_speeds(0.0)?.first().copied().unwrap_or(f64::INFINITY))
    }

    /// All spin speeds Ω at which a circular frequency is `order` Ω, lowest first; for order 0 those at which one is zero.
    ///
    /// With `q = z exp(i n Ω t)` they are the positive eigenvalues 1/Ω² of a Hermitian matrix:
    /// `Λ z = Ω² (n² I + N_aa − K_aa − 2 i n G_a) z`.
    ///
    /// # Errors
    /// [`SteadyError::Numbers`] for numbers that are not finite.
    pub fn critical_speeds(&self, order: f64) -> Result<Vec<f64>, SteadyError> {
        let nf = self.circular_frequencies.len();
        let omega = &self.circular_frequencies;
        let (s, g) = (&self.softening, &self.gyroscopic);
        let scaled = Mat::from_fn(nf, nf, |i, j| {
            let real = order * order * delta(i, j) + 0.5 * (s[(i, j)] + s[(j, i)]);
            let imaginary = -order * (g[(i, j)] - g[(j, i)]);
            c64::new(real, imaginary) / (omega[i] * omega[j])
        });
        let inverse_squares = scaled.self_adjoint_eigenvalues(Side::Lower).map_err(|_| SteadyError::Numbers)?;
        let mut speeds: Vec<f64> = inverse_squares.into_iter().filter(|x| *x > 0.0).map(|x| x.sqrt().recip()).collect();
        speeds.sort_by(f64::total_cmp);
        Ok(speeds)
    }
}

fn delta(i: usize, j: usize) -> f64 {
    f64::from(u8::from(i == j))
}
