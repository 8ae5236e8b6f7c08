//! Small vibrations of a body whose spin is held: what a Campbell diagram shows.
//!
//! ```text
//! q̈ + 2Ω G_a q̇ + (Λ − Ω² (N_aa − K_aa)) q = Ω² c_aa
//! ```
//!
//! G_a, N_aa and K_aa are those of the spin axis a (see [`reduced_body::ReducedBody`]). It is the conservative form with ω = Ω a
//! given, without damping, about the undeformed body.

use diagnostic::{Diagnosis, Diagnostic, Kind};
use faer::{Mat, Side, c64};
use nalgebra::Vector3;
use reduced_body::ReducedBody;

use crate::body::effect::{Effect, EffectMap};
use crate::body::spin_stiffness::SpinStiffness;
use crate::conservative::InCoordinates;

/// The constants of the vibrations of a body that spins about an axis.
#[derive(Debug, Clone)]
pub struct SteadySpin {
    circular_frequencies: Vec<f64>,
    /// G_a (nf×nf); zero without Coriolis terms.
    gyroscopic: Mat<f64>,
    /// N_aa − K_aa (nf×nf); each part zero where its effect is off.
    softening: Mat<f64>,
}

/// A vibration at a spin speed: `exp((growth + i·circular_frequency) t)`, as the body sees it.
#[derive(Debug, Clone, PartialEq)]
pub struct SpinMode {
    /// rad per time, not negative.
    pub circular_frequency: f64,
    /// Positive where the vibration grows.
    pub growth: f64,
    /// Angular momentum of the vibration about the spin axis: 1 where all points circle forwards, −1 backwards, 0 where
    /// they go to and fro. Zero without Coriolis terms.
    pub whirl: f64,
    /// Its shape: (Λ^½ q, q̇), of unit length (2nf).
    pub state: Vec<c64>,
}

/// An eigenvalue problem that the linear algebra could not solve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "the vibrations of the spinning body cannot be found: the eigenvalues of a matrix of size {size} did not converge; see by \
     `flexframe modes` whether its frequencies are as expected, and check material, units and spin speed"
)]
pub struct EigenError {
    /// Its size.
    pub size: usize,
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
    /// [`EigenError`] for numbers that are not finite.
    pub fn modes(&self, speed: f64) -> Result<Vec<SpinMode>, EigenError> {
        let nf = self.circular_frequencies.len();
        let omega = &self.circular_frequencies;
        // With x = Λ^½ q and y = q̇ all entries are frequencies.
        let matrix = Mat::from_fn(2 * nf, 2 * nf, |row, column| match (row < nf, column < nf) {
            (true, true) => 0.0,
            (true, false) => delta(row, column - nf) * omega[row],
            (false, true) => {
                let i = row - nf;
                -delta(i, column) * omega[i] + speed * speed * self.softening[(i, column)] / omega[column]
            }
            (false, false) => -2.0 * speed * self.gyroscopic[(row - nf, column - nf)],
        });
        let eigen = matrix.eigen().map_err(|_| EigenError { size: 2 * nf })?;
        let eigenvalues: Vec<c64> = eigen.S().column_vector().iter().copied().collect();
        // Of each pair ±, the one that turns forwards in time, or where the frequency is zero the one that grows.
        let scale = omega.iter().copied().fold(speed.abs(), f64::max);
        let zero = 1e-9 * scale;
        let mut chosen: Vec<usize> = (0..2 * nf).filter(|&k| eigenvalues[k].im > zero).collect();
        let mut still: Vec<usize> = (0..2 * nf).filter(|&k| eigenvalues[k].im.abs() <= zero).collect();
        still.sort_by(|&a, &b| eigenvalues[b].re.total_cmp(&eigenvalues[a].re));
        chosen.extend(still.into_iter().take(nf.saturating_sub(chosen.len())));
        let mut modes: Vec<SpinMode> = chosen
            .into_iter()
            .map(|k| {
                let z = eigenvalues[k];
                let state: Vec<c64> = eigen.U().col(k).iter().copied().collect();
                let length = state.iter().map(|x| x.norm_sqr()).sum::<f64>().sqrt();
                SpinMode {
                    circular_frequency: if z.im > zero { z.im } else { 0.0 },
                    growth: if z.re.abs() <= zero { 0.0 } else { z.re },
                    whirl: self.whirl(&state),
                    state: state.into_iter().map(|x| x / length).collect(),
                }
            })
            .collect();
        modes.sort_by(|a, b| a.circular_frequency.total_cmp(&b.circular_frequency));
        Ok(modes)
    }

    /// Im(qᴴ G q)/(qᴴ q): the mean angular momentum of `u = Ψ q` about the axis is `½ ω Im(qᴴ G q)`.
    fn whirl(&self, state: &[c64]) -> f64 {
        let q: Vec<c64> = state.iter().zip(&self.circular_frequencies).map(|(x, omega)| x / omega).collect();
        let mut momentum = 0.0;
        for (i, a) in q.iter().enumerate() {
            for (j, b) in q.iter().enumerate() {
                momentum += self.gyroscopic[(i, j)] * (a.conj() * b).im;
            }
        }
        let size = q.iter().map(|x| x.norm_sqr()).sum::<f64>();
        if size > 0.0 { momentum / size } else { 0.0 }
    }

    /// The spin speed at which Λ − Ω² (N_aa − K_aa) loses definiteness; infinite where it never does.
    ///
    /// # Errors
    /// [`EigenError`] for numbers that are not finite.
    pub fn critical_speed(&self) -> Result<f64, EigenError> {
        Ok(self.critical_speeds(0.0)?.first().copied().unwrap_or(f64::INFINITY))
    }

    /// All spin speeds Ω at which a circular frequency is `order` Ω, lowest first; for order 0 those at which one is zero.
    ///
    /// With `q = z exp(i n Ω t)` they are the positive eigenvalues 1/Ω² of a Hermitian matrix:
    /// `Λ z = Ω² (n² I + N_aa − K_aa − 2 i n G_a) z`.
    ///
    /// # Errors
    /// [`EigenError`] for numbers that are not finite.
    pub fn critical_speeds(&self, order: f64) -> Result<Vec<f64>, EigenError> {
        let nf = self.circular_frequencies.len();
        let omega = &self.circular_frequencies;
        let (s, g) = (&self.softening, &self.gyroscopic);
        let scaled = Mat::from_fn(nf, nf, |i, j| {
            let real = order * order * delta(i, j) + 0.5 * (s[(i, j)] + s[(j, i)]);
            let imaginary = -order * (g[(i, j)] - g[(j, i)]);
            c64::new(real, imaginary) / (omega[i] * omega[j])
        });
        let inverse_squares = scaled.self_adjoint_eigenvalues(Side::Lower).map_err(|_| EigenError { size: nf })?;
        let mut speeds: Vec<f64> = inverse_squares.into_iter().filter(|x| *x > 0.0).map(|x| x.sqrt().recip()).collect();
        speeds.sort_by(f64::total_cmp);
        Ok(speeds)
    }
}

fn delta(i: usize, j: usize) -> f64 {
    f64::from(u8::from(i == j))
}

impl Diagnostic for EigenError {
    fn diagnosis(&self) -> Diagnosis {
        Kind::Run.alone()
    }
}
