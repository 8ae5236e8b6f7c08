//! Models that are known to be wrong.

use std::fmt;

use dynamics::{DrivenMotion, Effect, EffectMap, LoadedMode, SteadySpin};
use nalgebra::Vector3;

use crate::motion::case::{AdviceError, Case};
use crate::motion::course::Course;
use crate::strain::backbone::DETUNED;
use crate::table::number::Number;

/// Deflection over length at which linear strain ends.
pub(crate) const LINEAR: f64 = 0.1;

/// Reason to refuse a model. All of them are about the model: about the body, only its elements can tell.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Refusal {
    /// K + Ω²(K_σ − N) of the modes is not definite.
    #[error(
        "the model has no rest in its spin of {} rad per time: K + Ω²(K_σ − N) of its modes is not positive definite from {} on; {of_body}; {} \
         (`refuse = false` in [effects] runs it all the same)",
        Number(*.spin), Number(*.critical),
        if *.stiffening {
            "take large modes (`large` in [modes]), or modes about the rest in the spin (`about` in [modes])"
        } else {
            "turn geometric_stiffening on, which this model is without"
        }
    )]
    Indefinite {
        /// |ω|.
        spin: f64,
        /// The speed that it must stay below.
        critical: f64,
        /// True if the stiffening was taken into account.
        stiffening: bool,
        /// The rest of the full body in this spin.
        of_body: RestOfBody,
    },
    /// The stiffness of the modes under the steady loads is not positive definite.
    #[error(
        "the model has no stable rest under its steady loads: one of its modes would grow by exp({} t) (divergence); {of_body}; \
         make the loads smaller, hold the body at more places, or take large modes (`large` in [modes]) \
         (`refuse = false` in [effects] runs it all the same)",
        Number(*.growth)
    )]
    Diverges {
        /// Rate at which it grows, per time.
        growth: f64,
        /// The rest of the full body under these loads.
        of_body: RestOfBody,
    },
    /// Two frequencies have met under steady loads that follow the body.
    #[error(
        "under the steady loads two vibrations of the model meet at {} rad per time and grow by exp({} t) (flutter): make the loads \
         smaller, or damp the modes by more (`refuse = false` in [effects] runs it all the same, and `flexframe check` tells by the \
         full body whether a vibration grows)",
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
    /// The strain energy of the model is negative, which no body has.
    #[error(
        "the large modes bend the body by {:.1} % of its length, where the strain energy of the model is negative, which no body has: \
         the answer means nothing; make the loads smaller or the body stiffer, or take modes about a bent rest (`about` in [modes]) \
         (`refuse = false` in [effects] runs it all the same)",
        100.0 * .deflection
    )]
    NegativeEnergy {
        /// Deflection of the large modes over the length.
        deflection: f64,
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

/// The full body where its model has no rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RestOfBody {
    /// It was not asked.
    NotAsked,
    /// It has a stable one.
    Stable {
        /// Largest displacement of a node.
        displacement: f64,
    },
    /// It has one that it would leave: its stiffness there is negative in some directions.
    Unstable {
        /// How many.
        directions: usize,
    },
    /// None was found.
    NotFound,
}

impl fmt::Display for RestOfBody {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotAsked => write!(
                f,
                "the body itself may have one: `flexframe check` tells by all of its elements at the rows of a run"
            ),
            Self::Stable { displacement } => write!(
                f,
                "the full body of the mesh has a stable one, where a node is displaced by up to {}",
                Number(*displacement)
            ),
            Self::Unstable { directions } => write!(
                f,
                "nor does the full body of the mesh stand: at its rest its stiffness is negative in {directions} direction(s)"
            ),
            Self::NotFound => write!(f, "of the full body of the mesh none was found either"),
        }
    }
}

impl Refusal {
    /// The same with what the full body does there.
    #[must_use]
    pub fn with_rest_of_body(self, found: RestOfBody) -> Self {
        match self {
            Self::Indefinite { spin, critical, stiffening, .. } => {
                Self::Indefinite { spin, critical, stiffening, of_body: found }
            }
            Self::Diverges { growth, .. } => Self::Diverges { growth, of_body: found },
            other => other,
        }
    }
}

/// A part of its frequency that a vibration must grow by to be refused: what is slower may be rounding.
const GROWS: f64 = 1e-3;

/// The refusal of vibrations under steady loads that grow faster than `damping_ratio` lets them, if any do.
pub fn unsteady(modes: &[LoadedMode], damping_ratio: f64) -> Option<Refusal> {
    let refusal = |&LoadedMode { circular_frequency, growth }: &LoadedMode| {
        if circular_frequency == 0.0 {
            return (growth > 0.0).then_some(Refusal::Diverges { growth, of_body: RestOfBody::NotAsked });
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

/// The refusal of modal displacements with a negative strain energy of the modes that bend the body, which bend large ones by this part of
/// the length, if they have one.
pub(crate) fn impossible(case: &Case, q: &[f64], deflection: f64) -> Option<Refusal> {
    let manifold = case.manifold?;
    let stiffness = |i: usize, j: usize| {
        let own = if i == j { case.body.circular_frequencies[i].powi(2) } else { 0.0 };
        own + case.coupling.map_or(0.0, |coupling| coupling[(i, j)])
    };
    let bent = manifold.bent();
    let work = |i: &usize| bent.iter().map(|j| 0.5 * stiffness(*i, *j) * q[*i] * q[*j]).sum::<f64>();
    let quadratic: f64 = bent.iter().map(work).sum();
    (quadratic + manifold.energy(q) < 0.0).then_some(Refusal::NegativeEnergy { deflection })
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
        let (manifold, q) = (case.manifold?, &case.initial.modal_displacement);
        let deflection: f64 = manifold.large().iter().map(|k| q[*k].abs() * case.peaks[*k] / case.length).sum();
        impossible(case, q, deflection)
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
    let of_body = RestOfBody::NotAsked;
    Ok((speed >= critical).then_some(Refusal::Indefinite { spin: speed, critical, stiffening, of_body }))
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
