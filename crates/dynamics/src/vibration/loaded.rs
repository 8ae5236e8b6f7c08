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

use diagnostic::{Diagnosis, Diagnostic, Kind};
use faer::linalg::solvers::{DenseSolveCore, Solve};
use faer::{Mat, c64};
use nalgebra::Vector3;

use crate::body::initial::Initial;
use crate::conservative::ConservativeBody;
use crate::equations::Equations;
use crate::error::{SetupError, StepError};
use crate::state::State;
use crate::vibration::system::body::BodyTerms;
use crate::vibration::system::configuration::BodyConfiguration;
use crate::vibration::system::error::SteadyError;
use crate::vibration::system::tie::stiffnesses;

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
    Eigen(#[from] SteadyError),
    /// The start is none of this body.
    #[error("{0}")]
    Setup(#[from] SetupError),
    /// A body with large modes does not come to rest under its loads.
    #[error(
        "the model finds no rest under its steady loads: they bend it further than its large modes hold; make the loads smaller or the body stiffer, or take modes about the bent rest (`about` in [modes])"
    )]
    NoRest,
}

/// First order of a body about rest in its frame, M ξ̈ + C ξ̇ + K ξ = forces: ξ are a displacement and a turn of the frame along the axes of the
/// body, and changes of the modes. Where something holds the frame, its reaction balances the first six rows.
#[derive(Debug, Clone)]
pub struct AtRest {
    /// Modal displacements at rest.
    pub modal_displacement: Vec<f64>,
    /// M, C and K ((6+nf)×(6+nf) each).
    pub mass: Mat<f64>,
    /// C.
    pub damping: Mat<f64>,
    /// K.
    pub stiffness: Mat<f64>,
    /// Forces (6+nf) of each load where its history is 1, as [`ConservativeBody::unit_forces`].
    pub unit_forces: Vec<Vec<f64>>,
    /// The motion of the frame that a unit of the drive's speed is.
    pub driven: Option<[f64; 6]>,
}

impl ConservativeBody {
    /// First order about the rest of the body in its frame under its loads and its drive as they are at a time, in the attitude of
    /// `initial`, by Newton's iteration from the undeformed body. `amplitudes` (nf) are small displacements.
    ///
    /// # Errors
    /// [`LoadedError::NoRest`] where it comes to none.
    pub fn at_rest(&self, initial: &Initial, amplitudes: &[f64], time: f64) -> Result<AtRest, LoadedError> {
        let nf = self.flexible();
        let mut q = vec![0.0; nf];
        for _ in 0..MOST {
            let (there, state) = self.still_at(initial, &q, time)?;
            let force = Mat::from_fn(nf, 1, |i, _| there.forces[6 + i]);
            let way = of_modes(&there.stiffness).partial_piv_lu().solve(&force);
            let size = (0..nf).map(|k| (way[(k, 0)] / amplitudes[k]).abs()).fold(0.0, f64::max);
            if !size.is_finite() {
                break;
            }
            if size <= AT_REST {
                let BodyTerms { mass, damping, stiffness, .. } = there;
                let motion = self.motion_state(&state).map_err(|error| error.in_step(time, 0.0))?;
                let unit_forces = self.unit_forces(&motion);
                let along = |[v, omega]: [Vector3<f64>; 2]| [v.x, v.y, v.z, omega.x, omega.y, omega.z];
                let driven = self.driven().map(along);
                return Ok(AtRest { modal_displacement: q, mass, damping, stiffness, unit_forces, driven });
            }
            let part = (STRIDE / size).min(1.0);
            q.iter_mut().enumerate().for_each(|(k, q)| *q += part * way[(k, 0)]);
        }
        Err(LoadedError::NoRest)
    }

    /// The terms and the state of the body with some modal displacements, which does not move but as its drive does.
    fn still_at(&self, initial: &Initial, q: &[f64], time: f64) -> Result<(BodyTerms, State), LoadedError> {
        let nf = self.flexible();
        let still = Initial::at_rest(nf);
        let still = Initial { attitude: initial.attitude, origin: initial.origin, ..still };
        let state = self.start_at(&Initial { modal_displacement: q.to_vec(), ..still }, time)?;
        let mut at = BodyConfiguration::still(self, &state);
        if let (Some(drive), Some([velocity, omega])) = (&self.drive, self.driven()) {
            let (speed, acceleration) = (drive.speed_at(time, time), drive.acceleration_at(time, time));
            (at.velocity, at.omega) = (velocity * speed, omega * speed);
            (at.velocity_rate, at.omega_rate) = (velocity * acceleration, omega * acceleration);
        }
        let mut terms = BodyTerms::new(self, &at, time);
        stiffnesses(self).enumerate().for_each(|(k, square)| terms.stiffness[(6 + k, 6 + k)] += square);
        Ok((terms, state))
    }

    /// The vibrations about the rest under the loads, slowest first. `amplitudes` (nf) are small modal displacements.
    ///
    /// # Errors
    /// [`LoadedError`].
    pub fn loaded_modes(&self, initial: &Initial, amplitudes: &[f64]) -> Result<Vec<LoadedMode>, LoadedError> {
        let squares = if self.manifold.is_some() {
            let rest = self.at_rest(initial, amplitudes, 0.0)?;
            self.inverse_mass(&rest.mass) * of_modes(&rest.stiffness)
        } else {
            of_modes(&self.still_at(initial, &vec![0.0; self.flexible()], 0.0)?.0.stiffness)
        };
        let eigenvalues: Vec<c64> = squares.eigenvalues().map_err(|_| SteadyError::Numbers)?;
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

    /// M⁻¹ of the modes (nf×nf) of a body that turns as it is free to.
    fn inverse_mass(&self, mass: &Mat<f64>) -> Mat<f64> {
        let (turns, nf) = (self.free_turns().len(), self.flexible());
        let axis = |k: usize| -> &Vector3<f64> { &self.axes[k] };
        let left = Mat::from_fn(6 + nf, turns + nf, |i, k| match (i, k < turns) {
            (3..6, true) => axis(k)[i - 3],
            (6.., false) => f64::from(u8::from(i - 6 == k - turns)),
            _ => 0.0,
        });
        let inverse = (left.transpose() * mass * &left).partial_piv_lu().inverse();
        inverse.get(turns.., turns..).to_owned()
    }
}

/// The part of a matrix over the modes.
fn of_modes(matrix: &Mat<f64>) -> Mat<f64> {
    matrix.get(6.., 6..).to_owned()
}

impl Diagnostic for LoadedError {
    fn diagnosis(&self) -> Diagnosis {
        match self {
            Self::Setup(error) => error.diagnosis(),
            Self::NoRest => Kind::Refused.alone(),
            Self::Rates(_) | Self::Eigen(_) => Kind::Run.alone(),
        }
    }
}
