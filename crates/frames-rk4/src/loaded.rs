//! Small vibrations of a body under loads that stay as they are: divergence and flutter.
//!
//! ```text
//! q̈ = −A q        A = Λ + Σ a (K − L)
//! ```
//!
//! K is the geometric stiffness of a load of amplitude a, and L the load stiffness of one that follows the deformation. A
//! real eigenvalue of A below zero is divergence, a pair of complex ones is flutter.

use faer::{Mat, c64};

use crate::conservative::ConservativeBody;
use crate::error::StepError;
use crate::initial::Initial;
use crate::steady_spin::EigenError;

/// A part of the frequency that growth must exceed to be more than rounding.
const ROUNDING: f64 = 1e-7;

/// A small vibration about the undeformed body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoadedMode {
    /// rad per time; zero where the body diverges without swinging.
    pub circular_frequency: f64,
    /// Rate at which it grows where nothing damps it, per time; zero where it does not.
    pub growth: f64,
}

/// Why the vibrations of a loaded body are not known.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LoadedError {
    /// The rates cannot be evaluated.
    #[error(transparent)]
    Rates(#[from] StepError),
    /// The eigenvalue problem has no answer.
    #[error(transparent)]
    Eigen(#[from] EigenError),
    /// The start is none of this body.
    #[error(transparent)]
    Setup(#[from] crate::error::SetupError),
}

impl ConservativeBody {
    /// A of the body at rest in the attitude of `initial`, with its loads as they are at time 0 (nf×nf). It is the central
    /// difference between modal displacements ±`amplitudes` (nf), exact for the loads of this crate.
    ///
    /// # Errors
    /// [`LoadedError`].
    pub fn loaded_stiffness(&self, initial: &Initial, amplitudes: &[f64]) -> Result<Mat<f64>, LoadedError> {
        let nf = self.flexible();
        let mut stiffness = Mat::zeros(nf, nf);
        for (k, amplitude) in amplitudes.iter().copied().enumerate().take(nf) {
            for sign in [1.0, -1.0] {
                let mut at = Initial { attitude: initial.attitude, ..Initial::at_rest(nf) };
                at.modal_displacement[k] = sign * amplitude;
                let rates = self.rates(&self.start(&at)?, 0.0)?;
                for (i, force) in rates.modal_force.iter().enumerate() {
                    stiffness[(i, k)] -= sign * 0.5 * force / amplitude;
                }
            }
        }
        Ok(stiffness)
    }

    /// The vibrations by [`loaded_stiffness`](Self::loaded_stiffness), slowest first.
    ///
    /// # Errors
    /// [`LoadedError`].
    pub fn loaded_modes(&self, initial: &Initial, amplitudes: &[f64]) -> Result<Vec<LoadedMode>, LoadedError> {
        let stiffness = self.loaded_stiffness(initial, amplitudes)?;
        let eigenvalues: Vec<c64> = stiffness.eigenvalues().map_err(|_| EigenError { size: self.flexible() })?;
        let mut modes: Vec<LoadedMode> = eigenvalues
            .into_iter()
            .map(|square| {
                let root = square.sqrt();
                let (frequency, growth) = (root.re.abs(), root.im.abs());
                let zero = ROUNDING * frequency.max(growth);
                LoadedMode {
                    circular_frequency: if frequency > zero { frequency } else { 0.0 },
                    growth: if growth > zero { growth } else { 0.0 },
                }
            })
            .collect();
        modes.sort_by(|a, b| a.circular_frequency.total_cmp(&b.circular_frequency));
        Ok(modes)
    }
}
