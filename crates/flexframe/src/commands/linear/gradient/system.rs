//! Rates of the vibrations of a system with its numbers: Eqs. (D15)–(D20) of `docs/method/gradients.md`.
//!
//! The equations of small motions are linear in each stiffness of springs, bushings and joints, in coordinates that do not depend on it: the
//! rate of K is the difference of two K, exact but for rounding. Of the numbers of a body, its rates in fixed coordinates and those
//! of its places meet the motions and the forces of its markers.

use std::f64::consts::TAU;
use std::ops::Range;

use dynamics::{CommonSpin, SteadyState, SystemMode};
use faer::linalg::solvers::Solve;
use faer::{Mat, c64};
use model::{BuildProgress, Builder, Model, Parameter};
use scene::System;

use super::damping::Damped;
use super::error::GradientError;
use super::number::{Number, Place};
use super::varying::{REPEATED, Varying, product};
use crate::commands::system_modes::{SystemModesError, TiedMotion, build, tied_motions};

/// A part of an entry that is rounding.
const ROUNDING: f64 = 1e-8;

/// A system whose numbers vary.
pub(crate) struct VariedSystem {
    pub system: System,
    builder: Builder,
    models: Vec<Model>,
}

/// Frequencies of the vibrations of a system, cycles per time, and their rates by number.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SystemRates {
    pub frequencies: Vec<f64>,
    pub repeated: Vec<Range<usize>>,
    pub rates: Vec<Vec<f64>>,
}

/// A system where it stands at the start.
struct Here<'a> {
    system: &'a System,
    models: &'a [Model],
    /// Numbers of the bodies in the scene.
    bodies: Vec<usize>,
    steady: SteadyState,
    modes: Vec<SystemMode>,
}

impl VariedSystem {
    /// The bodies of a scene.
    pub fn new(system: &System, builder: &Builder, progress: impl FnMut(BuildProgress)) -> Result<Self, GradientError> {
        let system = system.clone();
        let models = build(&system, builder, progress)?;
        Ok(Self { system, builder: builder.clone(), models })
    }

    /// Frequencies and their rates of a scene with other numbers, at rest where it stands at the start.
    pub fn rates(&self, system: &System, numbers: &[Number]) -> Result<SystemRates, GradientError> {
        let is_same = |i: usize| system.bodies[i].body == self.system.bodies[i].body;
        let anew =
            if (0..system.bodies.len()).all(is_same) { None } else { Some(build(system, &self.builder, |_| ())?) };
        let here = Here::new(system, anew.as_deref().unwrap_or(&self.models))?;
        let repeated = here.repeated();
        let varying = self.varying(&here, numbers)?;
        let rates = numbers.iter().enumerate().map(|(i, number)| match &number.place {
            Place::Body(body, _) => {
                let (of_body, k) = varying[*body]
                    .as_ref()
                    .and_then(|(body, of)| Some((body, of.iter().position(|n| *n == i)?)))
                    .ok_or_else(|| here.loaded())?;
                here.frequency_rates(&repeated, |a, b| {
                    let motions = [&a.motion[..], &b.motion[..]];
                    of_body.change(a.eigenvalue, motions, [&[], &[]], &of_body.body.rates[k])
                })
            }
            _ => here.stiffness_rates(number, &repeated),
        });
        let rates = rates.collect::<Result<_, _>>()?;
        let frequencies = here.modes.iter().map(|mode| mode.circular_frequency() / TAU).collect();
        Ok(SystemRates { frequencies, repeated, rates })
    }

    /// The bodies of which numbers vary, by number in the scene, with the places of these in the list.
    fn varying<'a>(
        &self,
        here: &Here<'a>,
        numbers: &[Number],
    ) -> Result<Vec<Option<(Varying<'a>, Vec<usize>)>>, GradientError> {
        let of_body = |body: usize| {
            let of = |(i, number): (usize, &Number)| match &number.place {
                Place::Body(of, parameter) if *of == body => Some((i, parameter.clone())),
                _ => None,
            };
            let (places, parameters): (Vec<usize>, Vec<Parameter>) = numbers.iter().enumerate().filter_map(of).unzip();
            if parameters.is_empty() {
                return Ok(None);
            }
            here.refuse_deformed()?;
            let place = here.bodies.iter().position(|of| *of == body).ok_or_else(|| here.loaded())?;
            let (scene, model) = (&here.system.bodies[body], &here.models[body]);
            let rates = self.builder.varied(scene, |_| ())?.in_joints(model, &parameters)?;
            let is_damped = model.damping_ratios().iter().any(|ratio| *ratio != 0.0);
            let damping =
                if is_damped { Damped::modes(&model.natural_frequencies(), &scene.modes.damping) } else { Vec::new() };
            let first = here.steady.linear.coordinates_of(place).start;
            Ok(Some((Varying { model, first, body: rates, damping }, places)))
        };
        (0..here.models.len()).map(of_body).collect()
    }
}

impl<'a> Here<'a> {
    fn new(system: &'a System, models: &'a [Model]) -> Result<Self, GradientError> {
        let (bodies, steady) = steady(system, models)?;
        let linear = &steady.linear;
        let failed = |source| SystemModesError::Steady { scene: system.bodies[0].path.clone(), source };
        let modes = linear.vibrations().map_err(failed)?.modes;
        let modes = modes.into_iter().filter(|mode| mode.circular_frequency() > 0.0).collect();
        for matrix in [&linear.stiffness, &linear.damping] {
            if (matrix - matrix.transpose()).norm_max() > ROUNDING * matrix.norm_max() {
                return Err(GradientError::Loaded { scene: system.bodies[0].path.clone() });
            }
        }
        Ok(Self { system, models, bodies, steady, modes })
    }

    fn loaded(&self) -> GradientError {
        GradientError::Loaded { scene: self.system.bodies[0].path.clone() }
    }

    /// Refuses bodies that stand deformed, and so elsewhere with other numbers.
    fn refuse_deformed(&self) -> Result<(), GradientError> {
        let is_still = |(place, body): (usize, &usize)| {
            let size = self.models[*body].body.inertia.trace().sqrt();
            self.steady.modal_displacement(place).iter().all(|q| q.abs() <= ROUNDING * size)
        };
        if self.bodies.iter().enumerate().all(is_still) { Ok(()) } else { Err(self.loaded()) }
    }

    fn repeated(&self) -> Vec<Range<usize>> {
        let is_one = |before: &SystemMode, after: &SystemMode| {
            (after.eigenvalue - before.eigenvalue).norm() <= REPEATED * after.eigenvalue.norm()
        };
        modal::repeated(&self.modes, is_one)
    }

    /// Rates with a stiffness.
    fn stiffness_rates(&self, number: &Number, repeated: &[Range<usize>]) -> Result<Vec<f64>, GradientError> {
        let (mut changed, value) = (self.system.clone(), number.value(self.system));
        number.set(&mut changed, 2.0 * value);
        let (there, linear) = (steady(&changed, self.models)?.1, &self.steady.linear);
        // A body that the stiffness deforms stands elsewhere, with other coordinates.
        if (&there.linear.basis - &linear.basis).norm_max() > ROUNDING * linear.basis.norm_max() {
            return Err(self.loaded());
        }
        let of_stiffness = (&there.linear.stiffness - &linear.stiffness) * faer::Scale(1.0 / value);
        self.frequency_rates(repeated, |a, b| product(&of_stiffness, &a.coordinates, &b.coordinates))
    }

    /// Rates of the frequencies by ηᵀ(s²M' + sC' + K')η of pairs of modes of one eigenvalue.
    fn frequency_rates(
        &self,
        repeated: &[Range<usize>],
        change: impl Fn(&SystemMode, &SystemMode) -> c64,
    ) -> Result<Vec<f64>, GradientError> {
        let modes = &self.modes;
        let mut rates = vec![0.0; modes.len()];
        let apart = (0..modes.len()).filter(|k| !repeated.iter().any(|group| group.contains(k))).map(|k| k..k + 1);
        for group in repeated.iter().cloned().chain(apart) {
            let found = of_group(&modes[group.clone()], &change, &self.steady.linear.damping);
            rates[group].copy_from_slice(&found.ok_or_else(|| self.loaded())?);
        }
        Ok(rates)
    }
}

/// The numbers of its bodies, and the one system of a scene where it stands at the start.
fn steady(system: &System, models: &[Model]) -> Result<(Vec<usize>, SteadyState), GradientError> {
    let mut motions = tied_motions(system, models)?;
    let (Some(TiedMotion { bodies, simulation, .. }), true) = (motions.pop(), motions.is_empty()) else {
        let (scene, count) = (system.bodies[0].path.clone(), motions.len() + 1);
        return Err(GradientError::Systems { scene, count });
    };
    let failed = |source| SystemModesError::Steady { scene: system.bodies[0].path.clone(), source };
    Ok((bodies, simulation.motion().steady_state(&CommonSpin::REST).map_err(failed)?))
}

/// Rates of the frequencies of modes of one eigenvalue s: those of s are the eigenvalues of −G⁻¹S with S the change of the equations and
/// G = Yᵀ(2s + C)Y. None where the numbers are not finite.
fn of_group(
    modes: &[SystemMode],
    change: &impl Fn(&SystemMode, &SystemMode) -> c64,
    damping: &Mat<f64>,
) -> Option<Vec<f64>> {
    let size = modes.len();
    let eigenvalue = modes.iter().map(|mode| mode.eigenvalue).sum::<c64>() * (1.0 / size as f64);
    let moved = Mat::from_fn(size, size, |i, j| {
        let (a, b) = (&modes[i].coordinates, &modes[j].coordinates);
        let along: c64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
        along * eigenvalue * 2.0 + product(damping, a, b)
    });
    let strained = Mat::from_fn(size, size, |i, j| -change(&modes[i], &modes[j]));
    let rates: Mat<c64> = moved.partial_piv_lu().solve(&strained);
    let found: Vec<c64> = if size == 1 { vec![rates[(0, 0)]] } else { rates.eigenvalues().ok()? };
    let mut found: Vec<f64> = found.into_iter().map(|rate| rate.im / TAU).collect();
    found.sort_by(f64::total_cmp);
    found.iter().all(|rate| rate.is_finite()).then_some(found)
}
