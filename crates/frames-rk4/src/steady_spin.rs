//! Small vibrations of a body whose spin is held: what a Campbell diagram shows.
//!
//! ```text
//! q̈ + 2Ω G_a q̇ + (Λ − Ω² (N_aa − K_aa)) q = Ω² c_aa
//! ```
//!
//! G_a, N_aa and K_aa are those of the spin axis a (see [`modal::ReducedBody`]). It is the conservative form with ω = Ω a
//! given, without damping, about the undeformed body.

use faer::{Mat, Side};
use modal::ReducedBody;
use nalgebra::Vector3;

use crate::physics::Effects;

/// The constants of the vibrations of a body that spins about an axis.
#[derive(Debug, Clone)]
pub struct SteadySpin {
    circular_frequencies: Vec<f64>,
    /// G_a (nf×nf); zero without Coriolis terms.
    gyroscopic: Mat<f64>,
    /// N_aa − K_aa (nf×nf); each part zero where its effect is off.
    softening: Mat<f64>,
}

/// A vibration at a spin speed: `exp((growth ± i·circular_frequency) t)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpinMode {
    /// rad per time.
    pub circular_frequency: f64,
    /// Positive where the vibration grows.
    pub growth: f64,
}

/// An eigenvalue problem that the linear algebra could not solve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the eigenvalues of a matrix of size {size} could not be found; check the modes for numbers that are no use")]
pub struct EigenError {
    /// Its size.
    pub size: usize,
}

impl SteadySpin {
    /// Spin about `axis`, a unit vector in body axes, with the effects that are on.
    pub fn new(body: &ReducedBody, axis: &Vector3<f64>, effects: &Effects) -> Self {
        let nf = body.flexible();
        let weight = |(i, j): (usize, usize)| if i == j { axis[i] * axis[i] } else { 2.0 * axis[i] * axis[j] };
        let projected = |matrices: &[Mat<f64>; 6]| {
            let terms = matrices.iter().zip(ReducedBody::PAIRS.map(weight));
            terms.fold(Mat::zeros(nf, nf), |sum, (matrix, w)| sum + matrix * faer::Scale(w))
        };
        let mut softening = Mat::zeros(nf, nf);
        if effects.deformed_inertia {
            softening += projected(&body.inertia_second);
            if let Some(stiffness) = body.stress_stiffness.as_ref().filter(|_| effects.geometric_stiffening) {
                softening -= projected(stiffness);
            }
        }
        let mut gyroscopic = Mat::zeros(nf, nf);
        if effects.coriolis {
            for (matrix, a) in body.gyroscopic.iter().zip(axis.iter()) {
                gyroscopic += matrix * faer::Scale(*a);
            }
        }
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
        let eigenvalues = matrix.eigenvalues().map_err(|_| EigenError { size: 2 * nf })?;
        // A diverging pair ±growth has no frequency; each vibration is counted once.
        let scale = omega.iter().copied().fold(speed.abs(), f64::max);
        let real = 1e-9 * scale;
        let mut modes: Vec<SpinMode> = eigenvalues
            .iter()
            .filter(|z| z.im > real || (z.im.abs() <= real && z.re >= 0.0))
            .map(|z| {
                let growth = if z.re.abs() <= real { 0.0 } else { z.re };
                SpinMode { circular_frequency: z.im.max(0.0), growth }
            })
            .collect();
        modes.sort_by(|a, b| a.circular_frequency.total_cmp(&b.circular_frequency));
        modes.truncate(nf);
        Ok(modes)
    }

    /// The spin speed at which Λ − Ω² (N_aa − K_aa) loses definiteness; infinite where it never does.
    ///
    /// # Errors
    /// [`EigenError`] for numbers that are not finite.
    pub fn critical_speed(&self) -> Result<f64, EigenError> {
        let nf = self.circular_frequencies.len();
        let omega = &self.circular_frequencies;
        let s = &self.softening;
        let scaled = Mat::from_fn(nf, nf, |i, j| 0.5 * (s[(i, j)] + s[(j, i)]) / (omega[i] * omega[j]));
        let eigenvalues = scaled.self_adjoint_eigenvalues(Side::Lower).map_err(|_| EigenError { size: nf })?;
        let largest = eigenvalues.iter().copied().fold(0.0, f64::max);
        Ok(if largest > 0.0 { largest.sqrt().recip() } else { f64::INFINITY })
    }
}

fn delta(i: usize, j: usize) -> f64 {
    f64::from(u8::from(i == j))
}
