//! A rotor on a support that does not turn: a rigid body that a joint turns about its axis of symmetry.
//!
//! In axes that do not turn with it, it moves as a body with an angular momentum h of its own,
//!
//! ```text
//! J φ̈ + φ̇ × h = moment,    h = J_p Ω e        e the axis, J_p the moment of inertia about it
//! ```
//!
//! since its inertia looks the same however far it has turned. Eq. (L13) of `docs/method/systems.md`.

use diagnostic::{Diagnosis, Diagnostic, Kind};
use faer::c64;
use nalgebra::{Matrix3, Vector3};

use crate::system::marker::Marker;
use crate::system::radau::SystemMotion;
use crate::system::stage::{put, vector};
use crate::vibration::system::configuration::{CommonSpin, Configuration};
use crate::vibration::system::error::SteadyError;
use crate::vibration::system::mode::SystemMode;
use crate::vibration::system::spin_mode::SpinMode;
use crate::vibration::system::steady::{SteadyState, check_spin};
use crate::vibration::system::terms::{Terms, along, springs};

/// Parts of the radius of gyration and of the inertia that a rotor may be off its axis, and off symmetry.
const SYMMETRIC: f64 = 1e-3;
/// Rate of a turn, as a part of the fastest, that is rounding, and part of a rate that may be across the axis of a joint that turns about it.
const STILL: f64 = 1e-12;
const ALONG: f64 = 1e-3;
/// Part of a row that is rounding.
const ROUNDING: f64 = 1e-6;

/// A rigid body that spins about the axis of a joint, on a support that does not.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rotor {
    /// Its number in the system, from 0.
    pub body: usize,
    /// The axis, in its axes.
    pub axis_body: Vector3<f64>,
    /// Its moment of inertia about the axis.
    pub polar_inertia: f64,
}

/// A joint that turns in a motion.
#[derive(Debug, Clone, PartialEq)]
pub struct TurningJoint {
    /// Its number.
    pub joint: usize,
    /// Rate of its turn, rad per time.
    pub rate: f64,
    /// The rotor that it spins, with its speed about its axis, relative to what carries it; or why there is none.
    pub rotor: Result<(Rotor, f64), RotorError>,
}

/// Reasons that no body spins alone about the axis of a joint.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RotorError {
    /// A rotor that bends.
    #[error(
        "found a flexible body beyond it; expected a rigid one; help: make the rotor rigid (`mass` and `inertia` in its table), and give its shaft to the support"
    )]
    Flexible,
    /// Something else holds the turn.
    #[error(
        "found that {by:?} holds the turn of the body beyond it; expected one that spins freely or by the drive of the joint; help: leave {by:?} out of the scene that is asked"
    )]
    Held {
        /// Name of the joint or coupling.
        by: String,
    },
    /// Something is tied to a place of the rotor.
    #[error(
        "found a spring, bushing or law on the body beyond it, or a spring along its turn; expected joints alone; help: tie it to the support"
    )]
    Sprung,
    /// A center of mass beside the axis.
    #[error(
        "found the center of mass of the body beyond it {distance:.3e} of its radius of gyration off the axis; expected it on the axis; help: balance it"
    )]
    Unbalanced {
        /// Distance from the axis over the radius of gyration.
        distance: f64,
    },
    /// An inertia that turns with the rotor.
    #[error(
        "found a body beyond it whose inertia across the axis differs by {part:.3e} of it from one direction to another; expected it the same in all; help: run it, since its equations change with its turn"
    )]
    Asymmetric {
        /// The difference over the inertia.
        part: f64,
    },
    /// No body is beyond the joint.
    #[error("found the ground on both sides; expected a body")]
    Nothing,
    /// The equations have no answer.
    #[error("{0}")]
    Steady(#[from] SteadyError),
}

impl SystemMotion {
    /// True if all bodies can spin together about the axis of a joint: no other joint and no spring to the ground holds them.
    ///
    /// # Errors
    /// [`SteadyError`].
    pub fn spins_together(&self, joint: usize) -> Result<bool, SteadyError> {
        let system = self.system();
        let (point_global, omega_global) = self.joint_axis(joint);
        let at = Configuration::of(self, &CommonSpin { omega_global, point_global });
        match check_spin(self, &Terms::new(system, &at)?, &at) {
            Err(SteadyError::Against { .. }) => return Ok(false),
            checked => checked?,
        }
        let mut velocities = vec![0.0; system.coordinates()];
        for (body, first) in at.bodies.iter().zip(&system.first) {
            put(&mut velocities, *first, &body.velocity);
            put(&mut velocities, first + 3, &body.omega);
        }
        Ok(!self.is_sprung(&velocities))
    }

    /// True if a spring or a force element resists a motion of the bodies from where they are at rest: dampers do not count.
    fn is_sprung(&self, velocities: &[f64]) -> bool {
        let at = Configuration::of(self, &CommonSpin::REST);
        springs(self.system(), &at).iter().any(|(_, tie)| tie.resists(velocities))
    }

    /// The body that the turn of a joint spins alone: that of its second marker, or of its first where that one is none.
    ///
    /// # Errors
    /// [`RotorError`], that of the second marker's body.
    pub fn rotor(&self, joint: usize) -> Result<Rotor, RotorError> {
        let [first, second] = self.system().joints()[joint].markers.each_ref().map(Marker::body);
        let found = second.ok_or(RotorError::Nothing).and_then(|body| self.rotor_of(joint, body));
        match first.map(|body| self.rotor_of(joint, body)) {
            Some(Ok(rotor)) if found.is_err() => Ok(rotor),
            Some(Err(error)) if second.is_none() => Err(error),
            _ => found,
        }
    }

    /// The joints that turn in the motion, with the rotors that they spin.
    pub fn turning_joints(&self) -> Vec<TurningJoint> {
        let omega = |marker: &Marker| -> Vector3<f64> {
            let state = marker.body().and_then(|body| self.state(body).ok());
            state.map_or_else(Vector3::zeros, |state| state.attitude.to_global(&state.omega_body))
        };
        let rate = |joint: usize| self.joint_coordinates(joint).turn_rate;
        let joints = self.system().joints().iter().enumerate();
        let fastest = joints.clone().map(|(joint, _)| rate(joint).abs()).fold(0.0, f64::max);
        let turns = joints.filter(|(joint, of)| {
            let [first, second] = of.markers.each_ref().map(omega);
            let across = (second - first).cross(&self.joint_axis(*joint).1).norm();
            rate(*joint).abs() > (STILL * fastest).max(ALONG.recip() * across)
        });
        turns
            .map(|(joint, of)| {
                let rate = rate(joint);
                // The turn is that of the second marker as the first sees it.
                let speed = |rotor: Rotor| if of.markers[1].body() == Some(rotor.body) { rate } else { -rate };
                TurningJoint { joint, rate, rotor: self.rotor(joint).map(|rotor| (rotor, speed(rotor))) }
            })
            .collect()
    }

    fn rotor_of(&self, joint: usize, body: usize) -> Result<Rotor, RotorError> {
        let system = self.system();
        let of = &system.bodies[body];
        if of.flexible() > 0 {
            return Err(RotorError::Flexible);
        }
        let at = Configuration::of(self, &CommonSpin::REST);
        let here = &at.bodies[body];
        let (point, axis) = self.joint_axis(joint);
        let axis_body = here.body_from_global * axis;
        let radius = of.radius_of_gyration();
        let distance = (here.body_from_global * (point - at.origin_global(here)[0])).cross(&axis_body).norm() / radius;
        if distance.is_nan() || distance > SYMMETRIC {
            return Err(RotorError::Unbalanced { distance });
        }
        let inertia = of.undeformed_inertia();
        let polar_inertia = axis_body.dot(&(inertia * axis_body));
        let across = Matrix3::identity() - axis_body * axis_body.transpose();
        let mean = 0.5 * (inertia.trace() - polar_inertia);
        let symmetric = axis_body * axis_body.transpose() * polar_inertia + across * mean;
        let part = (inertia - symmetric).norm() / inertia.norm();
        if part.is_nan() || part > SYMMETRIC {
            return Err(RotorError::Asymmetric { part });
        }
        self.check_turn(joint, &at, (body, &axis_body))?;
        Ok(Rotor { body, axis_body, polar_inertia })
    }

    /// Refuses a body whose turn about an axis something resists.
    fn check_turn(
        &self,
        joint: usize,
        at: &Configuration,
        (body, axis_body): (usize, &Vector3<f64>),
    ) -> Result<(), RotorError> {
        let system = self.system();
        if system.elements().iter().any(|element| element.markers().iter().any(|marker| marker.body() == Some(body))) {
            return Err(RotorError::Sprung);
        }
        let terms = Terms::new(system, at)?;
        let first = system.first[body] + 3;
        let mut turned = vec![0.0; system.coordinates()];
        put(&mut turned, first, axis_body);
        let name = &system.joints()[joint].name;
        let rows = system.connections.names().zip(system.connections.is_driven()).enumerate();
        for (row, (by, is_driven)) in rows {
            let size =
                terms.rows[row].iter().flat_map(|end| &end.entries).fold(0.0_f64, |most, entry| most.max(entry.abs()));
            let is_own = is_driven && by == name;
            if !is_own && along(&terms.rows[row], &turned).abs() > ROUNDING * size {
                return Err(RotorError::Held { by: by.to_owned() });
            }
        }
        if self.is_sprung(&turned) { Err(RotorError::Sprung) } else { Ok(()) }
    }

    /// The steady state at rest while a rotor spins at a speed, and others at theirs, with its linearised equations: coordinates of the rotor
    /// are along axes that do not turn with it.
    ///
    /// # Errors
    /// [`SteadyError`].
    pub fn rotor_state(&self, rotor: &Rotor, speed: f64, others: &[(Rotor, f64)]) -> Result<SteadyState, SteadyError> {
        let others = others.iter().map(|(rotor, speed)| (rotor, *speed));
        self.steady_state_with_rotors(&CommonSpin::REST, others.chain([(rotor, speed)]))
    }

    /// The steady state in a common spin in which rotors spin against what carries them, at a speed each: along axes that turn with the bodies.
    ///
    /// # Errors
    /// [`SteadyError`].
    pub fn steady_state_with_rotors<'a>(
        &self,
        spin: &CommonSpin,
        rotors: impl IntoIterator<Item = (&'a Rotor, f64)>,
    ) -> Result<SteadyState, SteadyError> {
        let mut at = Configuration::of(self, spin);
        for (rotor, speed) in rotors {
            at.bodies[rotor.body].own_momentum += rotor.axis_body * (rotor.polar_inertia * speed);
        }
        SteadyState::near(self, at, Some(spin))
    }

    /// The vibrations while a rotor spins at a speed in rad per time, and others at theirs, slowest first: one for each independent
    /// coordinate. Their `whirl` is that of the rotor: 1 where it circles about its axis forwards, −1 backwards.
    ///
    /// # Errors
    /// [`SteadyError`].
    pub fn rotor_modes(
        &self,
        rotor: &Rotor,
        speed: f64,
        others: &[(Rotor, f64)],
    ) -> Result<Vec<SpinMode>, SteadyError> {
        let linear = self.rotor_state(rotor, speed, others)?.linear;
        let whirl = |mode: &SystemMode| if speed == 0.0 { 0.0 } else { self.circling(rotor, &mode.motion) };
        linear.all_modes(|mode| linear.spin_mode(mode, whirl(mode)))
    }

    /// How far a rotor circles forwards in a vibration.
    fn circling(&self, rotor: &Rotor, motion: &[c64]) -> f64 {
        let of = &self.system().bodies[rotor.body];
        let [mut forwards, mut all] = [0.0; 2];
        let across = 0.5 * (of.undeformed_inertia().trace() - rotor.polar_inertia);
        for (part, weight) in [(0, of.mass()), (3, across)] {
            let first = self.system().first[rotor.body] + part;
            let [real, imaginary]: [Vec<f64>; 2] =
                [motion.iter().map(|x| x.re).collect(), motion.iter().map(|x| x.im).collect()];
            let [real, imaginary] = [&real, &imaginary].map(|list| {
                let of_rotor = vector(list, first);
                of_rotor - rotor.axis_body * rotor.axis_body.dot(&of_rotor)
            });
            // x = Re((a + ib) e^iωt) = a cos ωt − b sin ωt turns as −a×b.
            forwards -= weight * 2.0 * real.cross(&imaginary).dot(&rotor.axis_body);
            all += weight * (real.norm_squared() + imaginary.norm_squared());
        }
        if all > 0.0 { forwards / all } else { 0.0 }
    }
}

impl Diagnostic for RotorError {
    fn diagnosis(&self) -> Diagnosis {
        Kind::Refused.alone()
    }
}
