//! Models that are known to be wrong.

use std::fmt;

use dynamics::{DrivenMotion, Effect, EffectMap, LoadedMode, SteadySpin};
use nalgebra::Vector3;

use crate::motion::case::{AdviceError, Case};
use crate::motion::course::Course;
use crate::strain::backbone::DETUNED;
use crate::strain::fourth_order::{FourthOrder, HOLDS};
use crate::table::number::Number;

/// Deflection over length at which linear strain ends.
pub(crate) const LINEAR: f64 = 0.1;

/// Part of the speed at which softening alone would take all stiffness, from which on a model without stiffening is
/// refused: there, a third of the lowest stiffness across the spin is gone.
pub const SOFTENED: f64 = 0.577;

/// Reason to refuse a model.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Refusal {
    /// K + Ω²(K_σ − N) is not definite.
    #[error(
        "the body spins at {} rad per time, beyond the {} at which K + Ω²(K_σ − N) loses definiteness: \
         linear modes have no rest there, though the body may have one; name the modes that bend it in `large` in [modes]{}, or \
         spin it slower (`refuse = false` in [effects] runs it all the same)",
        Number(*.spin), Number(*.critical), if *.stiffening { "" } else { ", turn geometric_stiffening on" }
    )]
    Unstable {
        /// |ω|.
        spin: f64,
        /// The speed that it must stay below.
        critical: f64,
        /// True if the stiffening was taken into account.
        stiffening: bool,
    },
    /// The centrifugal force softens the body, and nothing stiffens it.
    #[error(
        "the body spins at {} rad per time, {:.0} % of the {} at which centrifugal softening takes all \
         stiffness, and geometric_stiffening is off: turn it on, or deformed_inertia off (`refuse = false` in [effects] runs it all the same)",
        Number(*.spin), 100.0 * .spin / .critical, Number(*.critical)
    )]
    Softened {
        /// |ω|.
        spin: f64,
        /// The speed at which no stiffness is left.
        critical: f64,
    },
    /// K + K_σ of the steady loads is not definite, or nearly so.
    #[error(
        "the steady loads are {factor:.4} times those at which the body buckles, where K + K_σ loses definiteness (from \
         {BUCKLED} on a run is refused): linear modes have no rest there; make them smaller, hold the body at more places, or \
         name the modes that bend it in `large` in [modes] (`refuse = false` in [effects] runs it all the same)"
    )]
    Buckled {
        /// The loads over those at which it buckles.
        factor: f64,
    },
    /// The steady loads, some of which follow the body, leave no stiffness against one of its vibrations.
    #[error(
        "the steady loads take all stiffness from one of the modes, which would grow by exp({} t) (divergence): make the \
         loads smaller, or hold the body at more places (`refuse = false` in [effects] runs it all the same)",
        Number(*.growth)
    )]
    Diverges {
        /// Rate at which it grows, per time.
        growth: f64,
    },
    /// Two frequencies have met under steady loads that follow the body.
    #[error(
        "under the steady loads two vibrations meet at {} rad per time and grow by exp({} t) (flutter): make the loads \
         smaller, or damp the modes by more (`refuse = false` in [effects] runs it all the same)",
        Number(*.circular_frequency), Number(*.growth)
    )]
    Flutters {
        /// rad per time.
        circular_frequency: f64,
        /// Rate at which it grows, per time, less what damping takes.
        growth: f64,
    },
    /// The body bends by more than its length.
    #[error(
        "the body bends by {} times its length, where strains are taken to be linear: the answer means nothing; make the \
         loads smaller or the body stiffer (`refuse = false` in [effects] runs it all the same)",
        Number(*.deflection)
    )]
    Deflected {
        /// The deflection over the length.
        deflection: f64,
    },
    /// The large modes bend the body further than the manifold holds.
    #[error(
        "the large modes bend the body by {:.1} % of its length, where {}: the answer means nothing; make the loads smaller \
         or the body stiffer (`refuse = false` in [effects] runs it all the same)",
        100.0 * .deflection, LeftOut(*.error)
    )]
    BeyondFourthOrder {
        /// Their deflection over the length.
        deflection: f64,
        /// Relative error of the forces on them by the orders left out, about; infinite where the strain energy is negative.
        error: f64,
    },
    /// A mode swings so far that its frequency is not that of linear strain.
    #[error(
        "mode {mode} bends the body by {:.1} % of its length, where linear strain has its frequency off by {:.0} % or more: \
         the answer means nothing; make the loads smaller or the body stiffer (`refuse = false` in [effects] runs it all \
         the same)",
        100.0 * .deflection, 100.0 * DETUNED
    )]
    Detuned {
        /// Number of the mode, the first flexible one is 1.
        mode: usize,
        /// Its deflection over the length.
        deflection: f64,
    },
}

/// The part that a motion of fourth order leaves out, in words.
pub(crate) struct LeftOut(pub f64);

impl fmt::Display for LeftOut {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_finite() {
            write!(
                f,
                "the orders beyond the fourth, which are left out, come to about {:.1} % of the forces",
                100.0 * self.0
            )
        } else {
            write!(f, "the strain energy to fourth order is negative, which no body has")
        }
    }
}

/// Part of the loads at which a body buckles that is refused: nothing is left there of the stiffness against the way it
/// buckles, and what is left is off by more than itself.
pub const BUCKLED: f64 = 0.99;

/// The refusal of a body under `factor` times the steady loads at which it buckles, if any.
pub fn buckling(factor: f64) -> Option<Refusal> {
    (factor >= BUCKLED).then_some(Refusal::Buckled { factor })
}

/// A part of its frequency that a vibration must grow by to be refused: what is slower may be rounding.
const GROWS: f64 = 1e-3;

/// The refusal of vibrations under steady loads that grow faster than `damping_ratio` lets them, if any do.
pub fn unsteady(modes: &[LoadedMode], damping_ratio: f64) -> Option<Refusal> {
    let refusal = |&LoadedMode { circular_frequency, growth }: &LoadedMode| {
        if circular_frequency == 0.0 {
            return (growth > 0.0).then_some(Refusal::Diverges { growth });
        }
        let growth = growth - damping_ratio * circular_frequency;
        (growth > GROWS * circular_frequency).then_some(Refusal::Flutters { circular_frequency, growth })
    };
    modes.iter().find_map(refusal)
}

/// The refusal of a deflection, over the length of the body, if any.
pub(crate) fn deflected(deflection: f64) -> Option<Refusal> {
    (deflection > 1.0).then_some(Refusal::Deflected { deflection })
}

/// The refusal of an amplitude of mode `k` from 0 by its own backbone, if that is known.
pub(crate) fn detuned(case: &Case, k: usize, amplitude: f64) -> Option<Refusal> {
    let backbone = case.backbones.get(k)?.as_ref()?;
    let deflection = amplitude * case.peaks[k] / case.length;
    (amplitude > backbone.largest_amplitude()).then_some(Refusal::Detuned { mode: k + 1, deflection })
}

/// The refusal of an `error` at a deflection over the length of the body, if any.
pub(crate) fn beyond(error: f64, deflection: f64) -> Option<Refusal> {
    (error > HOLDS).then_some(Refusal::BeyondFourthOrder { deflection, error })
}

/// The refusal of the amplitudes that the modes have at the beginning, if any: of their displacement, and of their
/// velocity where nothing stiffens the body and the run lasts a quarter of their period.
fn bent_at_start(case: &Case) -> Option<Refusal> {
    let still = case.initial.omega == Vector3::zeros() && case.drive.is_none();
    let amplitude = |k: usize| {
        let (omega, initial) = (case.body.circular_frequencies[k], case.initial);
        let swings = still && omega * case.end >= std::f64::consts::FRAC_PI_2;
        let damped = (-std::f64::consts::FRAC_PI_2 * case.damping_ratios[k]).exp();
        let rate = if swings { initial.modal_velocity[k] / omega * damped } else { 0.0 };
        initial.modal_displacement[k].abs().max(rate.abs())
    };
    let modes = 0..case.body.flexible();
    let largest = modes.clone().map(|k| amplitude(k) * case.peaks[k] / case.length).fold(0.0, f64::max);
    let of_large = || {
        let mut order = FourthOrder::new(case.manifold?, &case.body.circular_frequencies);
        let q = &case.initial.modal_displacement;
        let deflection: f64 = order.large().iter().map(|k| q[*k].abs() * case.peaks[*k] / case.length).sum();
        beyond(order.error(q), deflection)
    };
    deflected(largest).or_else(|| modes.into_iter().find_map(|k| detuned(case, k, amplitude(k)))).or_else(of_large)
}

/// The spin that there is without doubt: at the beginning, or driven. `None` where the body does not turn.
fn certain_spin(case: &Case) -> Option<(Vector3<f64>, f64)> {
    let omega = match case.drive.map(|drive| (drive.motion, drive)) {
        Some((DrivenMotion::Turn { axis }, drive)) => {
            axis * (drive.speed.amplitude
                * Course::new(&drive.speed.history, case.end, case.costly_histories()).largest)
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
    effects: &EffectMap<bool>,
) -> Result<Option<Refusal>, AdviceError> {
    // Of large modes, what a spin does follows from where it bends them to.
    let is_small = case.manifold.is_none();
    if !(effects[Effect::Rotation] && effects[Effect::DeformedInertia] && is_small) || case.body.flexible() == 0 {
        return Ok(None);
    }
    let critical = SteadySpin::new(case.body, axis, effects).critical_speed()?;
    let stiffening = effects[Effect::GeometricStiffening] && case.body.stress_stiffness.is_some();
    Ok(if speed >= critical {
        Some(Refusal::Unstable { spin: speed, critical, stiffening })
    } else if !stiffening && speed >= SOFTENED * critical {
        Some(Refusal::Softened { spin: speed, critical })
    } else {
        None
    })
}

/// The reason why a model is known to be wrong, if it is: by the spin at the beginning, or the one that is driven, and by
/// the deflection that it begins with. What the loads may cause is left to [`crate::Advice::refusal`] and
/// [`crate::Review`].
///
/// # Errors
/// [`AdviceError`]: lists of the wrong length, numbers out of range, and an eigenvalue problem without an answer.
pub fn limits(case: &Case, effects: &EffectMap<bool>) -> Result<Option<Refusal>, AdviceError> {
    case.check(1.0)?;
    let of_spin = match certain_spin(case) {
        Some((axis, speed)) => refusal(case, &axis, speed, effects)?,
        None => None,
    };
    Ok(of_spin.or_else(|| bent_at_start(case)))
}
