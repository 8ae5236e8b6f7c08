//! Small vibrations of a body under loads that stay as they are: divergence and flutter.
//!
//! ```text
//! q̈ = −A q        A = Λ + Σ a (K − L)
//! ```
//!
//! K is the geometric stiffness of a load of amplitude a, and L the load stiffness of one that follows the deformation. A
//! real eigenvalue of A below zero is divergence, a pair of complex ones is flutter.
//!
//! With large modes the loads may bend the body far: the vibrations are then those about its rest q₀ under them,
//!
//! ```text
//! f(q₀) = 0        M(q₀) δq̈ = −A δq,   A = −∂f/∂q at q₀
//! ```
//!
//! f are the modal forces of a body that does not move. Without large modes f is linear and A the same everywhere.

use faer::linalg::solvers::Solve;
use faer::{Mat, c64};

use crate::body::initial::Initial;
use crate::conservative::ConservativeBody;
use crate::equations::{Equations, Evaluation, Oscillators};
use crate::error::StepError;
use crate::state::State;
use crate::vibration::steady_spin::EigenError;

/// A part of the frequency that growth must exceed to be more than rounding.
const ROUNDING: f64 = 1e-7;
/// Most iterations to the rest under loads, and what may be left of the way, in the given amplitudes.
const MOST: usize = 50;
const AT_REST: f64 = 1e-8;
/// Largest step of an iteration, in the given amplitudes.
const STRIDE: f64 = 50.0;

/// A small vibration about the rest under loads.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoadedMode {
    /// rad per time; zero where the body diverges without swinging.
    pub circular_frequency: f64,
    /// Rate at which it grows where nothing damps it, per time; zero where it does not.
    pub growth: f64,
}

/// Errors of the vibrations of a loaded body.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LoadedError {
    /// The rates cannot be evaluated.
    #[error("{0}")]
    Rates(#[from] StepError),
    /// The eigenvalue problem has no answer.
    #[error("{0}")]
    Eigen(#[from] EigenError),
    /// The start is none of this body.
    #[error("{0}")]
    Setup(#[from] crate::error::SetupError),
    /// A body with large modes does not come to rest under its loads.
    #[error(
        "the model finds no rest under its steady loads: they bend it further than its large modes hold; make the loads smaller or the body stiffer, or take modes about the bent rest (`about` in [modes])"
    )]
    NoRest,
}

impl ConservativeBody {
    /// A of the body at rest in the attitude of `initial` about the modal displacements `rest` (nf), with its loads as they
    /// are at a time (nf×nf). It is the central difference between displacements by ±`amplitudes` (nf); without large modes
    /// that is exact for the loads of this crate.
    ///
    /// # Errors
    /// [`LoadedError`].
    pub fn loaded_stiffness(
        &self,
        initial: &Initial,
        rest: &[f64],
        amplitudes: &[f64],
        time: f64,
    ) -> Result<Mat<f64>, LoadedError> {
        let nf = self.flexible();
        let mut stiffness = Mat::zeros(nf, nf);
        for (k, amplitude) in amplitudes.iter().copied().enumerate().take(nf) {
            for sign in [1.0, -1.0] {
                let mut q = rest.to_vec();
                q[k] += sign * amplitude;
                for (i, force) in self.forces_at_rest(initial, q, time)?.into_iter().enumerate() {
                    stiffness[(i, k)] -= sign * 0.5 * force / amplitude;
                }
            }
        }
        Ok(stiffness)
    }

    /// The modal displacements (nf) at which the body is at rest under its loads as they are at a time, in the attitude of
    /// `initial`, by Newton's iteration from the undeformed body. `amplitudes` (nf) are small displacements.
    ///
    /// # Errors
    /// [`LoadedError::NoRest`] where it comes to none.
    pub fn loaded_rest(&self, initial: &Initial, amplitudes: &[f64], time: f64) -> Result<Vec<f64>, LoadedError> {
        let nf = self.flexible();
        let mut q = vec![0.0; nf];
        for _ in 0..MOST {
            let force = self.forces_at_rest(initial, q.clone(), time)?;
            let force = Mat::from_fn(nf, 1, |i, _| force[i]);
            let way = self.loaded_stiffness(initial, &q, amplitudes, time)?.partial_piv_lu().solve(&force);
            let size = (0..nf).map(|k| (way[(k, 0)] / amplitudes[k]).abs()).fold(0.0, f64::max);
            if !size.is_finite() {
                break;
            }
            let part = (STRIDE / size).min(1.0);
            q.iter_mut().enumerate().for_each(|(k, q)| *q += part * way[(k, 0)]);
            if size <= AT_REST {
                return Ok(q);
            }
        }
        Err(LoadedError::NoRest)
    }

    /// p' of the body that is at rest with some modal displacements.
    fn forces_at_rest(
        &self,
        initial: &Initial,
        modal_displacement: Vec<f64>,
        time: f64,
    ) -> Result<Vec<f64>, LoadedError> {
        let at = Initial { attitude: initial.attitude, modal_displacement, ..Initial::at_rest(self.flexible()) };
        let [_, force] = self.mode_rates(&self.start_at(&at, time)?)?;
        Ok(force)
    }

    /// M⁻¹ (nf×nf) at some modal displacements: the modal velocities of unit momenta.
    fn inverse_mass(&self, initial: &Initial, modal_displacement: &[f64]) -> Result<Mat<f64>, LoadedError> {
        let nf = self.flexible();
        let at = Initial {
            attitude: initial.attitude,
            modal_displacement: modal_displacement.to_vec(),
            ..Initial::at_rest(nf)
        };
        let mut state = self.start(&at)?;
        let mut inverse = Mat::zeros(nf, nf);
        let [_, first_p] = self.first_modes();
        for k in 0..nf {
            state.values[first_p..first_p + nf].fill(0.0);
            state.values[first_p + k] = 1.0;
            let [velocity, _] = self.mode_rates(&state)?;
            for (i, velocity) in velocity.into_iter().enumerate() {
                inverse[(i, k)] = velocity;
            }
        }
        Ok(inverse)
    }

    /// q' and p' at a state.
    fn mode_rates(&self, state: &State) -> Result<[Vec<f64>; 2], StepError> {
        let mut e = self.evaluation();
        e.place_mut().copy_from_slice(&state.values);
        self.rates([state.time; 2], &self.frame(state), &mut e).map_err(|error| error.in_step(state.time, 0.0))?;
        self.add_linear(&mut e);
        let rates = e.rates();
        Ok(self.first_modes().map(|first| rates[first..first + self.flexible()].to_vec()))
    }

    /// The vibrations about the rest under the loads, slowest first. `amplitudes` (nf) are small modal displacements.
    ///
    /// # Errors
    /// [`LoadedError`].
    pub fn loaded_modes(&self, initial: &Initial, amplitudes: &[f64]) -> Result<Vec<LoadedMode>, LoadedError> {
        let squares = if self.manifold.is_some() {
            let rest = self.loaded_rest(initial, amplitudes, 0.0)?;
            self.inverse_mass(initial, &rest)? * self.loaded_stiffness(initial, &rest, amplitudes, 0.0)?
        } else {
            self.loaded_stiffness(initial, &vec![0.0; self.flexible()], amplitudes, 0.0)?
        };
        let eigenvalues: Vec<c64> = squares.eigenvalues().map_err(|_| EigenError { size: self.flexible() })?;
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
