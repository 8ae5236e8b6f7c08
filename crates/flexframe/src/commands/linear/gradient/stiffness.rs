//! Rates of the vibrations of a system with the stiffnesses of its springs, bushings and joints: Eqs. (D15) and (D16) of
//! `docs/method/gradients.md`.
//!
//! The equations of small motions are linear in each of them, in coordinates that do not depend on it: the rate of K is the difference of
//! two K, exact but for rounding.

use std::f64::consts::TAU;
use std::ops::Range;

use dynamics::{CommonSpin, SteadyState, SystemMode};
use faer::linalg::solvers::Solve;
use faer::{Mat, c64};
use model::{BuildProgress, Builder, Model};
use scene::{AlongAndAbout, System, one_of};

use super::error::GradientError;
use crate::commands::system_modes::{SystemModesError, build, tied_motions};

/// Eigenvalues that are apart by less than this part are one.
const REPEATED: f64 = 1e-8;
/// A part of an entry that is rounding.
const ROUNDING: f64 = 1e-8;

/// A stiffness of a scene, with the path of its key.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Stiffness {
    pub name: String,
    place: Place,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Place {
    Spring(usize),
    /// Number, true about an axis, axis.
    Bushing(usize, bool, usize),
    Joint(usize),
}

/// A system whose stiffnesses vary.
pub(crate) struct VariedSystem {
    pub system: System,
    models: Vec<Model>,
}

/// Frequencies of the vibrations of a system, cycles per time, and their rates by stiffness.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SystemRates {
    pub frequencies: Vec<f64>,
    pub repeated: Vec<Range<usize>>,
    pub rates: Vec<Vec<f64>>,
}

impl Stiffness {
    /// All of a scene that are not zero.
    pub fn all(system: &System) -> Vec<Self> {
        let springs = system
            .springs
            .iter()
            .enumerate()
            .map(|(i, _)| Self { name: format!("springs[{i}].stiffness"), place: Place::Spring(i) });
        let of_bushing = |i: usize| {
            let of = move |(kind, about): (&'static str, bool)| {
                (0..3).map(move |axis| Self {
                    name: format!("bushings[{i}].stiffness.{kind}[{axis}]"),
                    place: Place::Bushing(i, about, axis),
                })
            };
            [("translation", false), ("rotation", true)].into_iter().flat_map(of)
        };
        let joints = system
            .joints
            .iter()
            .enumerate()
            .filter(|(_, joint)| joint.spring.is_some())
            .map(|(i, _)| Self { name: format!("joints[{i}].spring.stiffness"), place: Place::Joint(i) });
        let all = springs.chain((0..system.bushings.len()).flat_map(of_bushing)).chain(joints);
        all.filter(|stiffness| stiffness.value(system) > 0.0).collect()
    }

    /// The stiffnesses of some names; all without any.
    pub fn named(system: &System, names: &[String]) -> Result<Vec<Self>, GradientError> {
        let all = Self::all(system);
        if names.is_empty() && !all.is_empty() {
            return Ok(all);
        }
        let of_name = |(i, name): (usize, &String)| {
            let known = all.iter().find(|stiffness| stiffness.name == *name).filter(|_| !names[..i].contains(name));
            known.cloned().ok_or_else(|| {
                let names: Vec<String> = all.iter().map(|stiffness| stiffness.name.clone()).collect();
                GradientError::Stiffness { name: name.clone(), expected: one_of(&names) }
            })
        };
        if names.is_empty() {
            let expected = "a spring, a bushing or a joint with a spring".to_owned();
            return Err(GradientError::Stiffness { name: "nothing that is stiff".to_owned(), expected });
        }
        names.iter().enumerate().map(of_name).collect()
    }

    /// Its value in a scene.
    pub fn value(&self, system: &System) -> f64 {
        match self.place {
            Place::Spring(i) => system.springs[i].stiffness,
            Place::Bushing(i, about, axis) => {
                let AlongAndAbout { translation, rotation } = system.bushings[i].stiffness;
                if about { rotation[axis] } else { translation[axis] }
            }
            Place::Joint(i) => system.joints[i].spring.map_or(0.0, |spring| spring.stiffness),
        }
    }

    /// Gives it a value in a scene.
    pub fn set(&self, system: &mut System, value: f64) {
        match self.place {
            Place::Spring(i) => system.springs[i].stiffness = value,
            Place::Bushing(i, about, axis) => {
                let AlongAndAbout { translation, rotation } = &mut system.bushings[i].stiffness;
                let list = if about { rotation } else { translation };
                list[axis] = value;
            }
            Place::Joint(i) => {
                if let Some(spring) = &mut system.joints[i].spring {
                    spring.stiffness = value;
                }
            }
        }
    }
}

impl VariedSystem {
    /// The bodies of a scene.
    pub fn new(system: &System, builder: &Builder, progress: impl FnMut(BuildProgress)) -> Result<Self, GradientError> {
        let system = system.clone();
        let models = build(&system, builder, progress)?;
        Ok(Self { system, models })
    }

    /// Frequencies and their rates of a scene with other stiffnesses, at rest where it stands at the start.
    pub fn rates(&self, system: &System, parameters: &[Stiffness]) -> Result<SystemRates, GradientError> {
        let here = self.steady(system)?;
        let linear = &here.linear;
        let failed = |source| SystemModesError::Steady { scene: system.bodies[0].path.clone(), source };
        let modes = linear.vibrations().map_err(failed)?.modes;
        let modes: Vec<SystemMode> = modes.into_iter().filter(|mode| mode.circular_frequency() > 0.0).collect();
        for matrix in [&linear.stiffness, &linear.damping] {
            if (matrix - matrix.transpose()).norm_max() > ROUNDING * matrix.norm_max() {
                return Err(GradientError::Loaded { scene: system.bodies[0].path.clone() });
            }
        }
        let is_one = |before: &SystemMode, after: &SystemMode| {
            (after.eigenvalue - before.eigenvalue).norm() <= REPEATED * after.eigenvalue.norm()
        };
        let repeated = modal::repeated(&modes, is_one);
        let rate = |parameter: &Stiffness| -> Result<Vec<f64>, GradientError> {
            let (mut changed, value) = (system.clone(), parameter.value(system));
            parameter.set(&mut changed, 2.0 * value);
            let there = self.steady(&changed)?;
            // A body that the stiffness deforms stands elsewhere, with other coordinates.
            if (&there.linear.basis - &linear.basis).norm_max() > ROUNDING * linear.basis.norm_max() {
                return Err(GradientError::Loaded { scene: system.bodies[0].path.clone() });
            }
            let of_stiffness = (&there.linear.stiffness - &linear.stiffness) * faer::Scale(1.0 / value);
            let mut rates = vec![0.0; modes.len()];
            let apart = (0..modes.len()).filter(|k| !repeated.iter().any(|group| group.contains(k))).map(|k| k..k + 1);
            for group in repeated.iter().cloned().chain(apart) {
                let found = of_group(&modes[group.clone()], &of_stiffness, &linear.damping)
                    .ok_or_else(|| GradientError::Loaded { scene: system.bodies[0].path.clone() })?;
                rates[group].copy_from_slice(&found);
            }
            Ok(rates)
        };
        let rates = parameters.iter().map(rate).collect::<Result<_, _>>()?;
        let frequencies = modes.iter().map(|mode| mode.circular_frequency() / TAU).collect();
        Ok(SystemRates { frequencies, repeated, rates })
    }

    /// The one system of a scene where it stands at the start.
    fn steady(&self, system: &System) -> Result<SteadyState, GradientError> {
        let motions = tied_motions(system, &self.models)?;
        let [motion] = &motions[..] else {
            let (scene, count) = (system.bodies[0].path.clone(), motions.len());
            return Err(GradientError::Systems { scene, count });
        };
        let failed = |source| SystemModesError::Steady { scene: system.bodies[0].path.clone(), source };
        Ok(motion.simulation.motion().steady_state(&CommonSpin::REST).map_err(failed)?)
    }
}

/// Rates of the frequencies of modes of one eigenvalue s: those of s are the eigenvalues of −G⁻¹S with S = YᵀK'Y and G = Yᵀ(2s + C)Y. None
/// where the numbers are not finite.
fn of_group(modes: &[SystemMode], of_stiffness: &Mat<f64>, damping: &Mat<f64>) -> Option<Vec<f64>> {
    let size = modes.len();
    let eigenvalue = modes.iter().map(|mode| mode.eigenvalue).sum::<c64>() * (1.0 / size as f64);
    let product = |matrix: &dyn Fn(usize, usize) -> c64, i: usize, j: usize| -> c64 {
        let (a, b) = (&modes[i].coordinates, &modes[j].coordinates);
        (0..a.len()).flat_map(|r| (0..b.len()).map(move |c| (r, c))).map(|(r, c)| a[r] * matrix(r, c) * b[c]).sum()
    };
    let strained = |r: usize, c: usize| c64::new(-of_stiffness[(r, c)], 0.0);
    let moved = |r: usize, c: usize| eigenvalue * if r == c { 2.0 } else { 0.0 } + damping[(r, c)];
    let block = |matrix: &dyn Fn(usize, usize) -> c64| Mat::from_fn(size, size, |i, j| product(matrix, i, j));
    let rates: Mat<c64> = block(&moved).partial_piv_lu().solve(&block(&strained));
    let found: Vec<c64> = if size == 1 { vec![rates[(0, 0)]] } else { rates.eigenvalues().ok()? };
    let mut found: Vec<f64> = found.into_iter().map(|rate| rate.im / TAU).collect();
    found.sort_by(f64::total_cmp);
    found.iter().all(|rate| rate.is_finite()).then_some(found)
}
