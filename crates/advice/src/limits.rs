//! Models that are known to be wrong.

use faer::{Mat, Side};
use frames_rk4::{DrivenMotion, Effects, EigenError, SteadySpin};
use modal::ReducedBody;
use nalgebra::Vector3;

use crate::case::{AdviceError, Case};
use crate::course::Course;

/// Part of the speed at which softening alone would take all stiffness, from which on a model without stiffening is
/// refused: there, a third of the lowest stiffness across the spin is gone.
pub const SOFTENED: f64 = 0.577;

/// Why a model is refused.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// K + Ω²(K_σ − N) is not definite.
    #[error(
        "the body spins at {spin:.4} rad per time, beyond the {critical:.4} at which K + Ω²(K_σ − N) loses definiteness: \
         it would bend without limit; spin it slower{} (`refuse = false` in [effects] runs it all the same)", if *.stiffening { "" } else { ", or turn geometric_stiffening on" }
    )]
    Unstable {
        /// |ω|.
        spin: f64,
        /// The speed that it must stay below.
        critical: f64,
        /// Whether the stiffening was taken into account.
        stiffening: bool,
    },
    /// The centrifugal force softens the body, and nothing stiffens it.
    #[error(
        "the body spins at {spin:.4} rad per time, {:.0} % of the {critical:.4} at which centrifugal softening takes all \
         stiffness, and geometric_stiffening is off: turn it on, or deformed_inertia off (`refuse = false` in [effects] runs it all the same)", 100.0 * .spin / .critical
    )]
    Softened {
        /// |ω|.
        spin: f64,
        /// The speed at which no stiffness is left.
        critical: f64,
    },
    /// K + K_σ of the steady loads is not definite.
    #[error(
        "the steady loads are {factor:.4} times those at which the body buckles, where K + K_σ loses definiteness: it \
         would bend without limit; make them smaller, or hold the body at more places"
    )]
    Buckled {
        /// The loads over those at which it buckles.
        factor: f64,
    },
}

/// The refusal of a body with the stress stiffness K_σ of its steady loads (nf×nf), if any.
///
/// # Errors
/// [`AdviceError::Eigen`] for numbers that are not finite.
pub fn buckling(body: &ReducedBody, load_stiffness: &Mat<f64>) -> Result<Option<Refusal>, AdviceError> {
    let omega = &body.circular_frequencies;
    let nf = omega.len();
    let scaled = Mat::from_fn(nf, nf, |i, j| load_stiffness[(i, j)] / (omega[i] * omega[j]));
    let eigenvalues = scaled.self_adjoint_eigenvalues(Side::Lower).map_err(|_| EigenError { size: nf })?;
    let factor = -eigenvalues.iter().copied().fold(0.0, f64::min);
    Ok((factor >= 1.0).then_some(Refusal::Buckled { factor }))
}

/// The spin that there is without doubt: at the beginning, or driven. `None` where the body does not turn.
fn certain_spin(case: &Case) -> Option<(Vector3<f64>, f64)> {
    let omega = match case.drive.map(|drive| (drive.motion, drive)) {
        Some((DrivenMotion::Turn { axis }, drive)) => {
            axis * (drive.amplitude * Course::new(&drive.history, case.end).largest)
        }
        Some((DrivenMotion::Slide { .. }, _)) => Vector3::zeros(),
        None => case.body.motion.rotation_projector() * case.initial.omega,
    };
    let speed = omega.norm();
    (speed > 0.0).then(|| (omega / speed, speed))
}

/// The refusal of a spin about a unit `axis` at `speed`, if any.
pub(crate) fn refusal(
    case: &Case,
    axis: &Vector3<f64>,
    speed: f64,
    effects: &Effects,
) -> Result<Option<Refusal>, AdviceError> {
    if !(effects.rotation && effects.deformed_inertia) || case.body.flexible() == 0 {
        return Ok(None);
    }
    let critical = SteadySpin::new(case.body, axis, effects).critical_speed()?;
    let stiffening = effects.geometric_stiffening && case.body.stress_stiffness.is_some();
    Ok(if speed >= critical {
        Some(Refusal::Unstable { spin: speed, critical, stiffening })
    } else if !stiffening && speed >= SOFTENED * critical {
        Some(Refusal::Softened { spin: speed, critical })
    } else {
        None
    })
}

/// The reason why a model is known to be wrong, if it is: by the spin at the beginning, or the one that is driven. What
/// the loads may cause is left to [`crate::Review`].
///
/// # Errors
/// [`AdviceError`]: lists of the wrong length, numbers out of range, and an eigenvalue problem without an answer.
pub fn limits(case: &Case, effects: &Effects) -> Result<Option<Refusal>, AdviceError> {
    case.check(1.0)?;
    match certain_spin(case) {
        Some((axis, speed)) => refusal(case, &axis, speed, effects),
        None => Ok(None),
    }
}
