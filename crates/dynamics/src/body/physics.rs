//! The physics that a motion is to have.

use faer::{Mat, Side};
use keys::{Key, Keyed};
use nalgebra::Vector3;
use serde::Deserialize;

use crate::body::effect::EffectMap;
use crate::conservative::manifold::Manifold;
use crate::error::SetupError;
use crate::history::{Expression, History, Table, finite};
use crate::load::signal::Signal;

/// A motion that something forces on the held part of a body. The body's own modes are those of the part held still
/// ([`reduced_body::RigidMotion::clamp`]).
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub struct Drive {
    /// How it moves.
    pub motion: DrivenMotion,
    /// How fast.
    pub speed: DrivenSpeed,
    /// A speed that a program adds from outside. It must not jump; its rate may.
    #[serde(skip)]
    pub added: Option<Signal>,
}

/// A speed over time: the amplitude times the history.
///
/// As data, tables and expressions have other types `T` and `E` than those that can be evaluated, as in [`History`].
#[derive(Debug, Clone, PartialEq, Deserialize, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct DrivenSpeed<T = Table, E = Expression> {
    /// Angular velocity, rad/time, or velocity, length/time, where the history is 1.
    pub amplitude: f64,
    /// Factor on the amplitude over time.
    pub history: History<T, E>,
}

/// How a driven part moves.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum DrivenMotion {
    /// Turning about an axis through the body's origin.
    Turn {
        /// Unit vector, the same in body and global axes.
        axis: Vector3<f64>,
    },
    /// Sliding along a direction.
    Slide {
        /// Unit vector.
        direction: Vector3<f64>,
    },
}

impl DrivenSpeed {
    /// Its value at a time, by the branch that holds at `branch_time`.
    pub(crate) fn at(&self, time: f64, branch_time: f64) -> f64 {
        self.amplitude * self.history.at(time, branch_time)
    }

    /// Its rate.
    pub(crate) fn rate(&self, time: f64, branch_time: f64) -> f64 {
        self.amplitude * self.history.rate(time, branch_time)
    }

    /// The amplitude times the largest factor up to a time.
    pub fn largest(&self, end: f64) -> f64 {
        self.amplitude * self.history.largest(end)
    }
}

impl Drive {
    /// Speed at a time, by the branch that holds at `branch_time`.
    pub(crate) fn speed_at(&self, time: f64, branch_time: f64) -> f64 {
        self.speed.at(time, branch_time) + self.added.as_ref().map_or(0.0, |added| added.at(time))
    }

    /// Its rate.
    pub(crate) fn acceleration_at(&self, time: f64, branch_time: f64) -> f64 {
        self.speed.rate(time, branch_time) + self.added.as_ref().map_or(0.0, Signal::rate)
    }

    /// Refuses numbers that are not finite, and a direction that is no unit vector.
    pub(crate) fn check(&self) -> Result<(), SetupError> {
        let DrivenSpeed { amplitude, history } = &self.speed;
        history.check()?;
        let (DrivenMotion::Turn { axis: unit } | DrivenMotion::Slide { direction: unit }) = self.motion;
        check_unit("the length of a drive's direction", &unit)?;
        finite("the speed of a drive", *amplitude)
    }
}

/// Refuses a direction that is no unit vector.
pub(crate) fn check_unit(what: &'static str, direction: &Vector3<f64>) -> Result<(), SetupError> {
    let found = direction.norm();
    if (found - 1.0).abs() > 1e-9 || found.is_nan() {
        return Err(SetupError::Value { what, found, expected: "1" });
    }
    Ok(())
}

/// Physics of a motion in the conservative form beside modes, damping and loads.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub struct Physics {
    /// Which effects are computed; all by default. Flexibility, damping and gravity are the matter of the body, its
    /// damping ratios and its loads: what these do not hold is not computed.
    pub effects: EffectMap<bool>,
    /// Drive of the held part.
    pub drive: Option<Drive>,
    /// Geometric stiffness Ψ_fᵀ K Ψ_f (nf×nf, symmetric) of the static response to the forces `M (1⊗e)` of a unit
    /// acceleration of a driven slide along e, or `M (I⊗[a×]) X` of a driven turn about a.
    #[serde(with = "reduced_body::as_data")]
    pub drive_stiffness: Option<Mat<f64>>,
    /// The manifold of large modes. Points, loads and `drive_stiffness` are then in its extended shapes; of the stiffness that
    /// of the modes counts.
    pub large_deflection: Option<Manifold>,
    /// Forces that hold the bent body that the modes are about, where that is not the undeformed one.
    pub reference: Option<ReferenceForces>,
    /// Stiffness between coordinates that are coupled, as `modal::Modes::with_answer` has them, beside that of each (nf×nf, symmetric).
    #[serde(with = "reduced_body::as_data")]
    pub coupling: Option<Mat<f64>>,
}

/// The strain energy g·q + ½ qᵀBq that a body has about a bent reference beside its stiffness and its manifold: g are the internal forces
/// there, which loads and spin of the reference balance; B takes from the stiffness what the stress of these would count twice, and
/// adds the work of g on displacements of second order.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub struct ReferenceForces {
    /// g (nf).
    pub force: Vec<f64>,
    /// B (nf×nf), symmetric.
    #[serde(with = "reduced_body::as_data")]
    pub stiffness: Mat<f64>,
}

impl ReferenceForces {
    /// Refuses sizes other than `nf`, and numbers that are not finite.
    pub(crate) fn check(&self, nf: usize) -> Result<(), SetupError> {
        let Self { force, stiffness } = self;
        let what = "the forces of a reference";
        if force.len() != nf {
            return Err(SetupError::Length { what, expected: nf, found: force.len() });
        }
        force.iter().try_for_each(|value| finite("a force of a reference", *value))?;
        check_stiffness(what, stiffness, nf)
    }
}

/// Refuses a stiffness of a size other than `nf`, and numbers that are not finite.
pub(crate) fn check_stiffness(what: &'static str, stiffness: &Mat<f64>, nf: usize) -> Result<(), SetupError> {
    for found in [stiffness.nrows(), stiffness.ncols()] {
        if found != nf {
            return Err(SetupError::Length { what, expected: nf, found });
        }
    }
    stiffness.col_iter().flat_map(|column| column.iter()).try_for_each(|value| finite(what, *value))
}

impl Physics {
    /// These circular frequencies; where coordinates are coupled, with the highest of √(Λ + B) in the place of the highest.
    pub fn with_highest(&self, circular_frequencies: &[f64]) -> Vec<f64> {
        let mut frequencies = circular_frequencies.to_vec();
        let size = frequencies.len();
        let highest = (0..size).max_by(|a, b| frequencies[*a].total_cmp(&frequencies[*b]));
        if let (Some(stiffness), Some(highest)) = (&self.coupling, highest) {
            let square = |k: usize| frequencies[k] * frequencies[k];
            let whole = Mat::from_fn(size, size, |i, j| stiffness[(i, j)] + if i == j { square(i) } else { 0.0 });
            let found = whole.self_adjoint_eigenvalues(Side::Lower);
            // It is no more than that of the sum of the largest.
            let bound = |_| vec![square(highest) + stiffness.norm_l2()];
            frequencies[highest] = found.unwrap_or_else(bound).into_iter().fold(square(highest), f64::max).sqrt();
        }
        frequencies
    }
}

impl Default for Physics {
    /// All effects; nothing drives or stresses the body.
    fn default() -> Self {
        Self {
            effects: EffectMap::all(),
            drive: None,
            drive_stiffness: None,
            large_deflection: None,
            reference: None,
            coupling: None,
        }
    }
}

impl Keyed for Drive {
    fn key(&self, key: Key) -> Key {
        let Self { motion, speed: DrivenSpeed { amplitude, history }, added } = self;
        let key = key.of("drive", 1).with("motion", motion).with("amplitude", amplitude).with("history", history);
        // Who sets it keeps it.
        key.with("has added speed", &added.is_some())
    }
}

impl Keyed for DrivenMotion {
    fn key(&self, key: Key) -> Key {
        match self {
            Self::Turn { axis } => key.of("turn", 1).with("axis", axis),
            Self::Slide { direction } => key.of("slide", 1).with("direction", direction),
        }
    }
}

impl Keyed for ReferenceForces {
    fn key(&self, key: Key) -> Key {
        key.of("reference forces", 1).with("force", &self.force).with("stiffness", &self.stiffness)
    }
}

impl Keyed for Physics {
    fn key(&self, key: Key) -> Key {
        let Self { effects, drive, drive_stiffness, large_deflection, reference, coupling } = self;
        let key = key
            .of("physics", 1)
            .with("effects", effects)
            .with("drive", drive)
            .with("drive stiffness", drive_stiffness)
            .with("large deflection", large_deflection);
        // Runs without these keep the keys that they had before there were any.
        let key = reference.iter().fold(key, |key, reference| key.with("reference", reference));
        coupling.iter().fold(key, |key, coupling| key.with("coupling", coupling))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed form: λ² − 5λ + 4 − 1.44 = 0.
    #[test]
    fn coordinates_that_are_coupled_have_a_higher_frequency_than_each_alone() {
        let stiffness = Mat::from_fn(2, 2, |i, j| if i == j { 0.0 } else { 1.2 });
        let physics = Physics { coupling: Some(stiffness.clone()), ..Physics::default() };
        let found = physics.with_highest(&[2.0, 1.0]);
        assert!(found[1] == 1.0 && (found[0] - (2.5 + 3.69_f64.sqrt()).sqrt()).abs() < 1e-14, "{found:?}");
        // About a bent reference the stiffness takes back what the stress of loads adds.
        let reference = Some(ReferenceForces { force: vec![0.0; 2], stiffness });
        assert_eq!(Physics { reference, ..Physics::default() }.with_highest(&[2.0, 1.0]), [2.0, 1.0]);
    }
}
