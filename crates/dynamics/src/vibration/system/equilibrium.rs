//! Static equilibria of a system: its bodies stand and are deformed so that no force is left, Eq. (L16) of `docs/method/systems.md`.
//!
//! Newton's method over all motions that the joints leave. The stiffness of each direction counts by its magnitude, so that the bodies go
//! down where the energy falls:
//!
//! ```text
//! K v_k = κ_k v_k,    δη = Σ v_k (v_k · Nᵀf) / |κ_k|
//! ```

use std::f64::consts::PI;

use faer::Mat;

use crate::system::description::System;
use crate::system::joint::coordinate::Coordinate;
use crate::system::radau::SystemMotion;
use crate::vibration::system::configuration::{CommonSpin, Configuration};
use crate::vibration::system::error::SteadyError;
use crate::vibration::system::graded::graded_modes;
use crate::vibration::system::linearization::Linearization;
use crate::vibration::system::steady::{ROUNDING, SteadyState, closed, size_of};
use crate::vibration::system::terms::{Terms, springs};

/// Most passes of Newton's method: to the equilibrium, and to each of the others.
const PASSES: usize = 200;
const FEWER_PASSES: usize = 60;
/// The largest turn, displacement or bending, as a part of the size of the system, of one pass.
const STRIDE: f64 = 0.25;
/// The longest way in a direction, relative to the system: more where nothing resists means nothing.
const REACH: f64 = 1e3;
/// The change at which it has converged, and a change that may be rounding: if it falls no more, it has converged, too.
const STILL: f64 = 1e-12;
const NEARLY_STILL: f64 = 1e-8;
/// Directions from an equilibrium in which others are looked for, softest first, and the strides of the way.
const DIRECTIONS: usize = 3;
const WAY: usize = 12;
/// Strides after which Newton's own step is tried from the way.
const TRIED: usize = 2;
/// Places that differ by less are one.
const SAME: f64 = 1e-3;
/// Where stiffnesses differ by less, two places are one equilibrium, along motions that nothing resists.
const SAME_STIFFNESS: f64 = 1e-4;

/// A system at rest, where no force is left.
#[derive(Debug, Clone)]
pub struct Equilibrium {
    /// The bodies, with the linearised equations.
    pub steady: SteadyState,
    /// The motions that lead away from it.
    pub stability: Stability,
    /// A joint that is turned by more than half a turn, and its angle.
    wound: Option<(String, f64)>,
    /// κ of the motions that forces resist or drive on.
    stiffnesses: Vec<f64>,
    /// Motions over all bodies that lead to others: those that deform no body, softest first, and those along which it is unstable.
    directions: Vec<Vec<f64>>,
}

/// The motions that lead away from an equilibrium.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub struct Stability {
    /// Independent motions in which the energy is highest there: the bodies leave it along them.
    pub unstable: usize,
    /// Independent motions that nothing resists.
    pub indifferent: usize,
}

/// Where Newton's method goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Way {
    /// Down the energy.
    Down,
    /// To the nearest equilibrium, which may be unstable.
    Nearest,
}

/// The stiffness of independent motions by its directions.
struct Directions {
    /// κ and v.
    modes: Vec<(f64, Vec<f64>)>,
    /// κ that is rounding.
    rounding: f64,
}

impl SystemMotion {
    /// The equilibrium that is down the energy from where the bodies are, of forces and drives at this time. Velocities do not count, and
    /// friction does not hold.
    ///
    /// # Errors
    /// [`SteadyError::NoEquilibrium`] where nothing holds a body against a force; [`SteadyError`].
    pub fn equilibrium(&self) -> Result<Equilibrium, SteadyError> {
        find(self, Configuration::of(self, &CommonSpin::REST), Way::Down, PASSES)
    }

    /// Other equilibria, stable or not, to which the softest motions of joints lead from one, in both senses. There may be more.
    ///
    /// # Errors
    /// [`SteadyError`] of the equations where a way begins. A way that leads to no equilibrium is left out.
    pub fn other_equilibria(&self, from: &Equilibrium) -> Result<Vec<Equilibrium>, SteadyError> {
        let mut found: Vec<Equilibrium> = Vec::new();
        let sizes = vec![self.size(); self.bodies.len()];
        for direction in &from.directions {
            for sense in [1.0, -1.0] {
                let mut at = from.steady.configuration.clone();
                let part = sense * STRIDE / size_of(self, direction, &sizes);
                let step: Vec<f64> = direction.iter().map(|x| part * x).collect();
                for stride in 1..=WAY {
                    go(self, &mut at, &step);
                    let terms = Terms::new(self.system(), &at)?;
                    go(self, &mut at, &terms.closing(self.system(), &terms.residuals));
                    let ways = match stride {
                        WAY => &[Way::Nearest, Way::Down][..],
                        stride if stride.is_multiple_of(TRIED) => &[Way::Nearest],
                        _ => &[],
                    };
                    for &way in ways {
                        let Ok(other) = find(self, at.clone(), way, FEWER_PASSES) else { continue };
                        let is_known = |known: &Equilibrium| {
                            size_of(self, &known.way_to(&other), &sizes) < SAME || known.is_of_family(&other)
                        };
                        if !std::iter::once(from).chain(&found).any(is_known) {
                            found.push(other);
                        }
                    }
                }
            }
        }
        Ok(found)
    }
}

impl Equilibrium {
    /// Where no force is left.
    fn of(system: &System, at: Configuration) -> Result<Self, SteadyError> {
        let terms = Terms::new(system, &at)?;
        let linear = Linearization::new(system, &terms, springs(system, &at))?;
        let Directions { modes, rounding } = Directions::of(&linear)?;
        let indifferent = modes.iter().filter(|(kappa, _)| kappa.abs() <= rounding).count();
        let unstable = modes.iter().filter(|(kappa, _)| *kappa < -rounding).count();
        // A body that is bent far is none of a few modes.
        let leads_on = |(kappa, v): &&(f64, Vec<f64>)| {
            *kappa < -rounding || *kappa > rounding && v[..linear.rigid].iter().map(|x| x * x).sum::<f64>() > 0.5
        };
        let leading = modes.iter().filter(leads_on).take(DIRECTIONS).map(|(_, v)| linear.expand(v)).collect();
        let mut turns = at.turns.iter().zip(system.joints());
        let wound = turns.find(|(turn, _)| turn.abs() > PI).map(|(turn, joint)| (joint.name.clone(), *turn));
        let steady = SteadyState::at_rest(system, at, terms, linear);
        let stiffnesses = modes.iter().map(|(kappa, _)| *kappa).filter(|kappa| kappa.abs() > rounding).collect();
        let stability = Stability { unstable, indifferent };
        Ok(Self { steady, stability, wound, stiffnesses, directions: leading })
    }

    /// A joint that is turned by more than half a turn, and its angle: a run that begins here counts from less.
    pub fn wound(&self) -> Option<(&str, f64)> {
        self.wound.as_ref().map(|(joint, turn)| (joint.as_str(), *turn))
    }

    /// True if another one differs along motions that nothing resists alone.
    fn is_of_family(&self, other: &Self) -> bool {
        let like = |(a, b): (&f64, &f64)| (a - b).abs() <= SAME_STIFFNESS * a.abs();
        self.stability.indifferent > 0
            && self.stiffnesses.len() == other.stiffnesses.len()
            && self.stiffnesses.iter().zip(&other.stiffnesses).all(like)
    }

    /// Changes of place from here to another one, over all bodies, of whose turns only the angle counts.
    fn way_to(&self, other: &Self) -> Vec<f64> {
        let bodies = self.steady.configuration.bodies.iter().zip(&other.steady.configuration.bodies);
        let way = bodies.flat_map(|(from, to)| {
            let moved = from.body_from_global * (to.origin - from.origin);
            let turned = [from.attitude.angle_to(&to.attitude), 0.0, 0.0];
            let bent = from.q.iter().zip(&to.q).map(|(from, to)| to - from);
            moved.iter().copied().chain(turned).chain(bent).collect::<Vec<_>>()
        });
        way.collect()
    }
}

/// Moves the bodies, and follows the turns of the joints.
fn go(motion: &SystemMotion, at: &mut Configuration, change: &[f64]) {
    at.change(motion.system(), change, Some(&CommonSpin::REST));
    for (number, joint) in motion.system().joints().iter().enumerate() {
        let places = at.places(&joint.markers);
        at.turns[number] = Coordinate::Turn.wrench(places.each_ref(), at.turns[number]).residual;
    }
}

fn find(motion: &SystemMotion, mut at: Configuration, way: Way, passes: usize) -> Result<Equilibrium, SteadyError> {
    let (system, sizes) = (motion.system(), vec![motion.size(); motion.bodies.len()]);
    let mass: f64 = system.bodies.iter().map(crate::ConservativeBody::mass).sum();
    let reach = REACH * mass.sqrt() * motion.size();
    // A spring that is slack or a stop makes the way turn back: then the steps become shorter.
    let (mut part, mut last, mut last_size) = (1.0_f64, Vec::<f64>::new(), f64::INFINITY);
    for pass in 0.. {
        let terms = Terms::new(system, &at)?;
        let linear = Linearization::new(system, &terms, Vec::new())?;
        let directions = Directions::of(&linear)?;
        let (mut change, forces) = closed(system, &terms, &linear);
        let sizes_of_forces = (0..linear.size()).map(|k| {
            let parts = terms.forces.iter().enumerate().map(|(i, force)| (linear.basis[(i, k)] * force).powi(2));
            parts.sum::<f64>().sqrt()
        });
        let rounding = ROUNDING * sizes_of_forces.fold(0.0, f64::max);
        let deflection = linear.expand(&directions.steps(&forces, (rounding, reach), way));
        change.iter_mut().zip(&deflection).for_each(|(sum, more)| *sum += more);
        let size = size_of(motion, &change, &sizes);
        if !size.is_finite() {
            return Err(SteadyError::Numbers);
        }
        if size <= STILL || (size <= NEARLY_STILL && size >= 0.5 * last_size) {
            // What is left would swing about it.
            go(motion, &mut at, &change);
            return Equilibrium::of(system, at);
        }
        if pass == passes {
            let body = furthest(motion, &change, &sizes);
            return Err(SteadyError::NoEquilibrium { body, passes });
        }
        let turns_back = last.iter().zip(&change).map(|(a, b)| a * b).sum::<f64>() < 0.0;
        part = if turns_back && size > 0.5 * last_size { 0.5 * part } else { (2.0 * part).min(1.0) };
        let scale = part * (STRIDE / size).min(1.0);
        (last, last_size) = (change.clone(), size);
        change.iter_mut().for_each(|change| *change *= scale);
        go(motion, &mut at, &change);
    }
    Err(SteadyError::Numbers)
}

impl Directions {
    fn of(linear: &Linearization) -> Result<Self, SteadyError> {
        let k = &linear.stiffness;
        let symmetric = Mat::from_fn(k.nrows(), k.ncols(), |i, j| 0.5 * (k[(i, j)] + k[(j, i)]));
        Ok(Self { modes: graded_modes(&symmetric)?, rounding: linear.rounding_of_stiffness() })
    }

    /// The change of the independent coordinates, along no direction by more than a reach.
    fn steps(&self, forces: &[f64], (rounding, reach): (f64, f64), way: Way) -> Vec<f64> {
        let mut change = vec![0.0; forces.len()];
        for (kappa, v) in &self.modes {
            let along: f64 = v.iter().zip(forces).map(|(v, force)| v * force).sum();
            if along.abs() > rounding {
                let size = (along / kappa.abs().max(self.rounding)).clamp(-reach, reach);
                let step = if way == Way::Nearest && *kappa < 0.0 { -size } else { size };
                change.iter_mut().zip(v).for_each(|(sum, v)| *sum += step * v);
            }
        }
        change
    }
}

/// The body that a change moves most.
fn furthest(motion: &SystemMotion, change: &[f64], sizes: &[f64]) -> String {
    let system = motion.system();
    let of_body = |b: usize| {
        let own = |k: usize| if (system.first[b]..system.first[b + 1]).contains(&k) { change[k] } else { 0.0 };
        size_of(motion, &(0..change.len()).map(own).collect::<Vec<_>>(), sizes)
    };
    let most = (0..sizes.len()).max_by(|a, b| of_body(*a).total_cmp(&of_body(*b))).unwrap_or(0);
    system.named(most).to_string()
}
