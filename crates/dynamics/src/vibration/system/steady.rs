//! The steady state of a system, Eq. (L7) of `docs/method/systems.md`: its bodies deformed as their loads, joints and spin ask.
//!
//! Eq. (L11) has the same for bodies that move against each other, whose accelerations are those of rigid bodies.
//!
//! Newton's method with the exact stiffness, over the motions that deform bodies: those that deform none stay where the system has
//! been put.

use nalgebra::Vector3;

use crate::body::motion_state::MotionState;
use crate::system::description::System;
use crate::system::joint::coordinate::Coordinate;
use crate::system::radau::SystemMotion;
use crate::system::stage::vector;
use crate::vibration::system::configuration::{BodyConfiguration, CommonSpin, Configuration};
use crate::vibration::system::error::SteadyError;
use crate::vibration::system::linearization::Linearization;
use crate::vibration::system::terms::{Terms, springs};
use crate::vibration::system::tie::Tie;

/// Most passes of Newton's method, and the change relative to the size of bodies at which it has converged.
const PASSES: usize = 40;
const STILL: f64 = 1e-12;
/// Largest turn and bending, as a part of the size of bodies, of one pass.
const STRIDE: f64 = 0.2;
/// Part of forces that is their rounding where they balance.
pub(super) const ROUNDING: f64 = 1e-13;
/// Rate of a row in a common spin, relative to the speed of the bodies, above which its joint does not allow the spin.
const AGAINST: f64 = 1e-6;

/// How far a steady state is from balance: the accelerations that are left, along motions that deform no body. Its linearised equations are
/// about that accelerated motion, at its instant.
#[derive(Debug, Clone, PartialEq)]
pub struct Unbalance {
    /// Acceleration of the origin of each body, in its axes.
    pub accelerations: Vec<Vector3<f64>>,
    /// Angular, in its axes.
    pub angular_accelerations: Vec<Vector3<f64>>,
}

/// A steady state and its linearised equations.
#[derive(Debug, Clone)]
pub struct SteadyState {
    pub(crate) configuration: Configuration,
    pub(crate) terms: Terms,
    /// The linearised equations.
    pub linear: Linearization,
    /// The forces that do not balance.
    pub unbalance: Unbalance,
    spin: Option<CommonSpin>,
}

impl SystemMotion {
    /// The steady state in a common spin of all bodies near where they are, with its linearised equations. Velocities of the motion
    /// do not count, nor do the rates of drives: their values do.
    ///
    /// # Errors
    /// [`SteadyError`].
    pub fn steady_state(&self, spin: &CommonSpin) -> Result<SteadyState, SteadyError> {
        SteadyState::near(self, Configuration::of(self, spin), Some(spin))
    }

    /// The state of all bodies in the motion that they have: each deformed as the forces of that motion and of its joints ask, with
    /// accelerations as of rigid bodies. Its linearised equations are those of this instant, as if it lasted.
    ///
    /// # Errors
    /// [`SteadyError`].
    pub fn moving_state(&self) -> Result<SteadyState, SteadyError> {
        let mut motion = self.clone();
        let rates = motion.rigid_accelerations().map_err(|_| SteadyError::Inertia)?;
        SteadyState::near(self, Configuration::moving(self, [&motion.first.velocities, &rates]), None)
    }

    /// The generalised forces, over the coordinates of all bodies, of a unit force or moment along a coordinate of a joint: its change is
    /// their product with the changes of place.
    pub fn coordinate_row(&self, at: &SteadyState, joint: usize, coordinate: Coordinate) -> Vec<f64> {
        let (system, at) = (self.system(), &at.configuration);
        let of = &system.joints()[joint];
        let mut tie = Tie::new(system, at, of.markers.iter());
        tie.add_coordinate(coordinate, &at.places(&of.markers), at.turns[joint], |_| (1.0, [0.0; 2]));
        let mut forces = vec![0.0; system.coordinates()];
        tie.add_forces(&mut forces);
        forces
    }
}

impl SteadyState {
    /// At rest, without forces that are left.
    pub(super) fn at_rest(system: &System, configuration: Configuration, terms: Terms, linear: Linearization) -> Self {
        let unbalance = Unbalance::new(system, &vec![0.0; system.coordinates()]);
        Self { configuration, terms, linear, unbalance, spin: Some(CommonSpin::REST) }
    }

    /// The common spin; `None` where bodies move against each other.
    pub fn spin(&self) -> Option<&CommonSpin> {
        self.spin.as_ref()
    }

    /// Modal displacements of a body.
    pub fn modal_displacement(&self, body: usize) -> &[f64] {
        &self.configuration.bodies[body].q
    }

    /// Multipliers of the rows of all joints and couplings.
    pub fn multipliers(&self) -> &[f64] {
        &self.terms.multipliers
    }

    /// Number of rows that others imply.
    pub fn implied_rows(&self) -> usize {
        self.terms.is_implied.iter().filter(|is_implied| **is_implied).count()
    }

    pub(crate) fn near(
        motion: &SystemMotion,
        mut at: Configuration,
        spin: Option<&CommonSpin>,
    ) -> Result<Self, SteadyError> {
        let system = motion.system();
        let sizes = sizes_of_bodies(motion);
        for pass in 0.. {
            let terms = Terms::new(system, &at)?;
            if spin.is_some() {
                check_spin(motion, &terms, &at)?;
            }
            let linear = Linearization::new(system, &terms, Vec::new())?;
            let (mut change, forces) = closed(system, &terms, &linear);
            let deflection = linear.expand(&linear.deflection(&forces));
            change.iter_mut().zip(&deflection).for_each(|(sum, more)| *sum += more);
            let size = size_of(motion, &change, &sizes);
            if !size.is_finite() {
                return Err(SteadyError::Numbers);
            }
            if size <= STILL {
                let rates = unbalanced(&linear, &terms);
                let (terms, linear) = match &rates {
                    Some(rates) => {
                        at.accelerate(system, rates);
                        let terms = Terms::new(system, &at)?;
                        let linear = Linearization::new(system, &terms, Vec::new())?;
                        (terms, linear)
                    }
                    None => (terms, linear),
                };
                let linear = Linearization { springs: springs(system, &at), ..linear };
                let unbalance = Unbalance::new(system, rates.as_deref().unwrap_or(&vec![0.0; system.coordinates()]));
                return Ok(Self { configuration: at, terms, linear, unbalance, spin: spin.copied() });
            }
            if pass == PASSES {
                break;
            }
            let part = (STRIDE / size).min(1.0);
            change.iter_mut().for_each(|change| *change *= part);
            at.change(system, &change, spin);
        }
        Err(SteadyError::NoRest { passes: PASSES })
    }
}

/// The radius of gyration of each body; of a point mass the size of the largest body.
fn sizes_of_bodies(motion: &SystemMotion) -> Vec<f64> {
    let radii = motion.system().bodies.iter().map(crate::ConservativeBody::radius_of_gyration);
    radii.map(|radius| if radius > 0.0 { radius } else { motion.size() }).collect()
}

/// The change of place that closes the joints, and the forces on independent coordinates after it.
pub(super) fn closed(system: &System, terms: &Terms, linear: &Linearization) -> (Vec<f64>, Vec<f64>) {
    let change = terms.closing(system, &terms.residuals);
    let mut forces = linear.project(&terms.forces);
    let by_closing = linear.project(&product(terms, linear, &change));
    forces.iter_mut().zip(&by_closing).for_each(|(force, less)| *force -= less);
    (change, forces)
}

/// (K + Λ) x over all coordinates.
fn product(terms: &Terms, linear: &Linearization, x: &[f64]) -> Vec<f64> {
    let mut forces = terms.stiffness_times(x);
    forces.iter_mut().zip(&linear.strain).zip(x).for_each(|((sum, strain), x)| *sum += strain * x);
    forces
}

/// The largest turn, displacement or bending of a body, relative to its size.
pub(super) fn size_of(motion: &SystemMotion, change: &[f64], sizes: &[f64]) -> f64 {
    let system = motion.system();
    let mut largest = 0.0_f64;
    for (b, size) in sizes.iter().enumerate() {
        let own = &change[system.first[b]..system.first[b + 1]];
        let norm = |list: &[f64]| list.iter().map(|x| x * x).sum::<f64>().sqrt();
        let bent = norm(&own[6..]) / system.bodies[b].mass().sqrt();
        let parts = [norm(&own[..3]) / size, norm(&own[3..6]), bent / size];
        largest = parts.into_iter().fold(largest, |most, part| if part.is_nan() { part } else { most.max(part) });
    }
    largest
}

/// Refuses a spin that a row forbids.
pub(super) fn check_spin(motion: &SystemMotion, terms: &Terms, at: &Configuration) -> Result<(), SteadyError> {
    let system = motion.system();
    let rim = |(of, body): (&BodyConfiguration, &crate::ConservativeBody)| {
        of.velocity.norm() + of.omega.norm() * body.radius_of_gyration()
    };
    let speeds = at.bodies.iter().zip(&system.bodies).map(rim);
    let scale = speeds.fold(0.0, f64::max);
    let is_driven = system.connections.is_driven();
    for ((rate, name), driven) in terms.row_rates.iter().zip(system.connections.names()).zip(is_driven) {
        if !driven && rate.abs() > AGAINST * scale {
            return Err(SteadyError::Against { joint: name.to_owned(), rate: *rate });
        }
    }
    Ok(())
}

/// The accelerations of all coordinates that the forces leave along motions that deform no body, if they are more than rounding.
fn unbalanced(linear: &Linearization, terms: &Terms) -> Option<Vec<f64>> {
    let mut forces = linear.project(&terms.forces);
    forces[linear.rigid..].fill(0.0);
    let parts = |k: usize| terms.forces.iter().enumerate().map(move |(i, force)| linear.basis[(i, k)] * force);
    let is_more = |k: usize| forces[k].abs() > ROUNDING * parts(k).map(f64::abs).sum::<f64>();
    (0..linear.rigid).any(is_more).then(|| linear.expand(&forces))
}

impl Unbalance {
    fn new(system: &System, accelerations: &[f64]) -> Self {
        let of = |part: usize| {
            let first = &system.first;
            first[..first.len() - 1].iter().map(|first| vector(accelerations, first + part)).collect()
        };
        Self { accelerations: of(0), angular_accelerations: of(3) }
    }
}

impl SteadyState {
    /// The state of each body.
    pub fn states(&self) -> Vec<MotionState> {
        self.states_by(|body| self.configuration.origin_global(body))
    }

    /// The same with positions and velocities in the frames of the bodies.
    pub(crate) fn states_in_frame(&self) -> Vec<MotionState> {
        self.states_by(|body| [body.origin, body.body_from_global.tr_mul(&body.velocity)])
    }

    fn states_by(&self, origin_and_velocity: impl Fn(&BodyConfiguration) -> [Vector3<f64>; 2]) -> Vec<MotionState> {
        let of_body = |body: &BodyConfiguration| MotionState {
            time: self.configuration.time,
            attitude: body.attitude,
            origin_global: origin_and_velocity(body)[0],
            velocity_global: origin_and_velocity(body)[1],
            omega_body: body.omega,
            modal_displacement: body.q.clone(),
            modal_velocity: vec![0.0; body.q.len()],
        };
        self.configuration.bodies.iter().map(of_body).collect()
    }
}
