//! Rates of the vibrations of a system with its numbers: Eq. (D16) of `docs/method/gradients.md`.
//!
//! The equations of small motions are linear in each stiffness of springs, bushings and joints, in coordinates that do not depend on it: the
//! rate of K is the difference of two K, exact but for rounding. Of the numbers of a body, its rates in fixed coordinates and those
//! of its places meet the motions and the forces of its markers.

use std::f64::consts::TAU;
use std::ops::Range;

use diagnostic::{Failure, Kind};
use dynamics::SystemMode;
use faer::linalg::solvers::Solve;
use faer::{Mat, c64};
use model::{BuildError, BuildProgress, Builder, Model, Needs, Parameter, VariedBody};
use scene::Scene;

use super::damping::Damped;
use super::found::{Found, RatesOfNumber};
use super::here::{Here, NumbersOfBody};
use super::number::{Number, Place};
use super::responses::Responses;
use super::varying::{Varying, product};
use crate::commands::modes::lone_body;

/// A pair of eigenvalues that is one parts by the root of rounding: G below this part of 2s YᵀY is singular.
const CRITICAL: f64 = 1e-7;

/// A body alone, or bodies in joints, whose numbers vary.
pub(crate) enum Varied {
    Body(Box<VariedBody>),
    System(Box<VariedSystem>),
}

impl Varied {
    pub fn new(scene: &Scene, builder: &Builder, progress: impl FnMut(BuildProgress)) -> Result<Self, Failure> {
        if scene.has_connections() {
            return Ok(Self::System(Box::new(VariedSystem::new(scene, builder, progress)?)));
        }
        let body = lone_body(scene).map_err(BuildError::from)?;
        Ok(Self::Body(Box::new(builder.needing(Needs::modes()).varied(body, progress)?)))
    }
}

/// A system whose numbers vary.
pub(crate) struct VariedSystem {
    system: Scene,
    builder: Builder,
    models: Vec<Model>,
}

impl VariedSystem {
    /// The bodies of a scene.
    fn new(scene: &Scene, builder: &Builder, progress: impl FnMut(BuildProgress)) -> Result<Self, Failure> {
        let scene = scene.clone();
        let models = builder.models(&scene, progress)?;
        Ok(Self { system: scene, builder: builder.clone(), models })
    }

    /// Frequencies and responses with their rates of a scene with other numbers, at rest where it stands at the start.
    pub fn rates(&self, scene: &Scene, numbers: &[Number], frequencies: &[f64]) -> Result<Found, Failure> {
        let is_same = |i: usize| scene.bodies[i].source == self.system.bodies[i].source;
        let anew = if (0..scene.bodies.len()).all(is_same) { None } else { Some(self.builder.models(scene, |_| ())?) };
        let here = Here::new(scene, anew.as_deref().unwrap_or(&self.models))?;
        let repeated = here.repeated();
        let varied = self.varied(&here, numbers)?;
        let of_stiffness = |number: &Number| match number.place {
            Place::Body(..) => Ok(None),
            _ => here.stiffness_rate(number).map(Some),
        };
        let stiffness_rates: Vec<Option<Mat<f64>>> = numbers.iter().map(of_stiffness).collect::<Result<_, _>>()?;
        let rates = numbers.iter().zip(&stiffness_rates).enumerate().map(|(i, (number, rate))| match rate {
            Some(rate) => {
                frequency_rates(&here, &repeated, number, |a, b| product(rate, &a.coordinates, &b.coordinates))
            }
            None => {
                let (_, of_body, k) = here.varying(i, number, &varied)?;
                frequency_rates(&here, &repeated, number, |a, b| {
                    let motions = [&a.motion[..], &b.motion[..]];
                    of_body.change(a.eigenvalue, motions, [&[], &[]], &of_body.body.rates[k])
                })
            }
        });
        let rates: Vec<Vec<f64>> = rates.collect::<Result<_, _>>()?;
        let Responses { responses, rates: of_responses } =
            here.responses(numbers, &stiffness_rates, &varied, frequencies)?;
        let of_number = |(frequencies, responses)| RatesOfNumber { frequencies, responses, ..Default::default() };
        Ok(Found {
            frequencies: here.modes.iter().map(|mode| mode.circular_frequency() / TAU).collect(),
            repeated,
            effective_masses: Vec::new(),
            statics: Vec::new(),
            responses,
            rates: rates.into_iter().zip(of_responses).map(of_number).collect(),
        })
    }

    /// The bodies of which numbers vary, by number in the scene, with the places of these in the list.
    fn varied<'a>(&self, here: &Here<'a>, numbers: &[Number]) -> Result<Vec<Option<NumbersOfBody<'a>>>, Failure> {
        let of_body = |body: usize| {
            let of = |(i, number): (usize, &Number)| match &number.place {
                Place::Body(of, parameter) if *of == body => Some((i, parameter.clone())),
                _ => None,
            };
            let (places, parameters): (Vec<usize>, Vec<Parameter>) = numbers.iter().enumerate().filter_map(of).unzip();
            let Some(first) = places.first() else { return Ok(None) };
            here.refuse_deformed()?;
            let place = here.motion.bodies.iter().position(|of| *of == body);
            let place = place.ok_or_else(|| here.outside(&numbers[*first]))?;
            let (scene, model) = (&here.system.bodies[body], &here.models[body]);
            let rates = self.builder.varied(scene, |_| ())?.in_joints(model, &parameters)?;
            let is_damped = model.damping_ratios().iter().any(|ratio| *ratio != 0.0);
            let damping =
                if is_damped { Damped::modes(&model.natural_frequencies(), &scene.modes.damping) } else { Vec::new() };
            let first = here.steady.linear.coordinates_of(place).start;
            Ok(Some(NumbersOfBody { body: Varying { model, first, body: rates, damping }, places }))
        };
        (0..here.models.len()).map(of_body).collect()
    }
}

/// Rates of the frequencies by ηᵀ(s²M' + sC' + K')η of pairs of modes of one eigenvalue.
fn frequency_rates(
    here: &Here<'_>,
    repeated: &[Range<usize>],
    number: &Number,
    change: impl Fn(&SystemMode, &SystemMode) -> c64,
) -> Result<Vec<f64>, Failure> {
    let modes = &here.modes;
    let mut rates = vec![0.0; modes.len()];
    let apart = (0..modes.len()).filter(|k| !repeated.iter().any(|group| group.contains(k))).map(|k| k..k + 1);
    for group in repeated.iter().cloned().chain(apart) {
        let frequency = modes[group.start].circular_frequency() / TAU;
        let not_finite = || {
            let words = format!(
                "found rates of the vibration at {frequency} cycles per time with {} that are not finite",
                number.name
            );
            let help = "look for values in the scene that are many powers of ten apart";
            Kind::Run.of(here.path()).help(help).says(words)
        };
        let group_modes = &modes[group.clone()];
        let moved = moved(group_modes, &here.steady.linear.damping);
        if is_critical(&moved, group_modes).ok_or_else(not_finite)? {
            let found = format!(
                "a vibration at {frequency} cycles per time that is damped critically (Yᵀ(2s + C)Y is singular)"
            );
            let wrong = Kind::Refused.of(here.path()).found(found).expected("one with rates");
            return Err(wrong.help("change the damping of joints, bushings or bodies a little").into());
        }
        rates[group].copy_from_slice(&of_group(group_modes, &change, &moved).ok_or_else(not_finite)?);
    }
    Ok(rates)
}

/// G = Yᵀ(2s + C)Y of modes of one eigenvalue s.
fn moved(modes: &[SystemMode], damping: &Mat<f64>) -> Mat<c64> {
    let size = modes.len();
    let eigenvalue = modes.iter().map(|mode| mode.eigenvalue).sum::<c64>() * (1.0 / size as f64);
    Mat::from_fn(size, size, |i, j| {
        let (a, b) = (&modes[i].coordinates, &modes[j].coordinates);
        let along: c64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
        along * eigenvalue * 2.0 + product(damping, a, b)
    })
}

/// True where G is singular beside 2s YᵀY; none where it is not finite.
fn is_critical(moved: &Mat<c64>, modes: &[SystemMode]) -> Option<bool> {
    let size = |mode: &SystemMode| {
        let length: f64 = mode.coordinates.iter().map(|x| x.norm_sqr()).sum();
        2.0 * mode.eigenvalue.norm() * length
    };
    let sizes: Vec<f64> = modes.iter().map(size).collect();
    let alike = Mat::from_fn(moved.nrows(), moved.ncols(), |i, j| moved[(i, j)] * (1.0 / (sizes[i] * sizes[j]).sqrt()));
    if !alike.norm_max().is_finite() {
        return None;
    }
    let least = alike.singular_values().ok()?.into_iter().fold(f64::INFINITY, f64::min);
    Some(least <= CRITICAL)
}

/// Rates of the frequencies of modes of one eigenvalue s: those of s are the eigenvalues of −G⁻¹S with S the change of the equations and
/// G = Yᵀ(2s + C)Y, `moved`. None where the numbers are not finite.
fn of_group(
    modes: &[SystemMode],
    change: &impl Fn(&SystemMode, &SystemMode) -> c64,
    moved: &Mat<c64>,
) -> Option<Vec<f64>> {
    let size = modes.len();
    let strained = Mat::from_fn(size, size, |i, j| -change(&modes[i], &modes[j]));
    let rates: Mat<c64> = moved.partial_piv_lu().solve(&strained);
    let found: Vec<c64> = if size == 1 { vec![rates[(0, 0)]] } else { rates.eigenvalues().ok()? };
    let mut found: Vec<f64> = found.into_iter().map(|rate| rate.im / TAU).collect();
    found.sort_by(f64::total_cmp);
    found.iter().all(|rate| rate.is_finite()).then_some(found)
}
