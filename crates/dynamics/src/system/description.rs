//! Bodies and what connects them.

pub(crate) mod islands;

use std::sync::Arc;

use nalgebra::Vector3;

use crate::conservative::ConservativeBody;
use crate::error::{BodyName, SetupError};
use crate::system::connections::Connections;
use crate::system::description::islands::{Island, islands};
use crate::system::element::ForceElement;
use crate::system::joint::Joint;
use crate::system::joint::coordinate::Coordinate;
use crate::system::joint::coupling::Coupling;
use crate::system::joint::equation::JointEquation;
use crate::system::joint::law::JointLaw;
use crate::system::joint::row::Row;
use crate::system::marker::Marker;
use crate::system::marker::motion::MarkerMotion;

/// The radius of gyration of a body of hardly any inertia over the size of the largest body.
const SMALL: f64 = 1e-2;

/// Bodies and what connects them.
#[derive(Debug, Clone)]
pub struct System {
    pub(crate) bodies: Vec<ConservativeBody>,
    /// Names of the bodies for messages; none of those that have none.
    names: Vec<Box<str>>,
    pub(crate) connections: Connections,
    /// First coordinate of each body, and the number of coordinates: six and the modes of each.
    pub(crate) first: Vec<usize>,
    /// Groups of bodies that joints or elements connect.
    pub(crate) islands: Vec<Island>,
    /// True for bodies whose angular momentum is counted about their own origins: rigid ones of hardly any inertia in islands on the ground.
    /// About the centre of the frame it would be the small difference of the moments of their momenta.
    pub(crate) spins_apart: Vec<bool>,
    /// The radius of gyration of each body.
    pub(crate) radii: Vec<f64>,
    /// The size of each body: its radius of gyration, or the distance of a marker from its origin.
    pub(crate) sizes: Vec<f64>,
    /// The error of places of the ground that hold bodies between them: numbers far from the origin round.
    pub(crate) rounding: f64,
}

impl System {
    /// Bodies that move freely but for the joints.
    ///
    /// # Errors
    /// [`SetupError`] for a body that is held or driven, and for a marker on a body that is not there or has other modes.
    pub fn new(bodies: Vec<ConservativeBody>, joints: Vec<Joint>) -> Result<Self, SetupError> {
        let mut first = vec![0];
        for body in &bodies {
            if !body.is_free() {
                return Err(SetupError::NotInFormulation {
                    formulation: "systems with joints",
                    what: "body that is held or driven",
                });
            }
            first.push(first[first.len() - 1] + 6 + body.flexible());
        }
        let connections = Connections { joints, ..Connections::default() };
        connections.markers().try_for_each(|marker| check(marker, &bodies))?;
        let radii = bodies.iter().map(ConservativeBody::radius_of_gyration).collect();
        let (names, islands, spins_apart, sizes) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Ok(Self { bodies, names, connections, first, islands, spins_apart, radii, sizes, rounding: 0.0 }.with_islands())
    }

    /// The same with names of its bodies for messages, in their order.
    #[must_use]
    pub fn with_names(mut self, names: Vec<Box<str>>) -> Self {
        self.names = names;
        self
    }

    /// The same with couplings of its joints.
    ///
    /// # Errors
    /// [`SetupError`] for a joint that is not there.
    pub fn with_couplings(mut self, couplings: Vec<Coupling>) -> Result<Self, SetupError> {
        let joints = self.connections.joints.len();
        if let Some(term) = couplings.iter().flat_map(|coupling| &coupling.terms).find(|term| term.joint >= joints) {
            let what = "the number of a joint in a coupling";
            return Err(SetupError::Value { what, found: term.joint as f64, expected: "that of a joint, from 0" });
        }
        self.connections.couplings = couplings;
        Ok(self)
    }

    /// The same with forces between markers.
    ///
    /// # Errors
    /// [`SetupError`] for a marker on a body that is not there or has other modes.
    pub fn with_elements(mut self, elements: Vec<Arc<dyn ForceElement>>) -> Result<Self, SetupError> {
        self.connections.set_elements(elements);
        self.connections.markers().try_for_each(|marker| check(marker, &self.bodies))?;
        Ok(self.with_islands())
    }

    /// The groups of bodies that nothing ties to the ground.
    pub(crate) fn free_groups(&self) -> impl Iterator<Item = &[usize]> {
        self.islands.iter().filter(|island| !island.is_on_ground).map(|island| &island.bodies[..])
    }

    /// Finds the islands and the sizes of the bodies.
    fn with_islands(mut self) -> Self {
        self.islands = islands(self.bodies.len(), self.connections.ties());
        self.sizes.clone_from(&self.radii);
        for marker in self.connections.markers() {
            if let Some(size) = marker.body().and_then(|body| self.sizes.get_mut(body)) {
                *size = size.max(marker.distance());
            }
        }
        self.spins_apart = vec![false; self.bodies.len()];
        for island in self.islands.iter().filter(|island| island.is_on_ground) {
            let largest = island.bodies.iter().map(|b| self.sizes[*b]).fold(0.0, f64::max);
            for b in &island.bodies {
                let body = &self.bodies[*b];
                let is_small = self.radii[*b] < SMALL * largest;
                self.spins_apart[*b] = body.flexible() == 0 && !body.is_point() && is_small;
            }
        }
        self
    }

    /// The same with other bodies in the place of these, such as the same ones under more loads.
    ///
    /// # Errors
    /// [`SetupError`] for another number of bodies, and as [`System::new`].
    pub fn with_bodies(self, bodies: Vec<ConservativeBody>) -> Result<Self, SetupError> {
        let (expected, found) = (self.bodies.len(), bodies.len());
        if found != expected {
            return Err(SetupError::Length { what: "the list of bodies", expected, found });
        }
        let Connections { joints, couplings, elements, .. } = self.connections;
        let system = Self::new(bodies, joints)?.with_couplings(couplings)?.with_elements(elements)?;
        Ok(system.with_names(self.names))
    }

    /// The same with one more law for the force along a coordinate of a joint.
    ///
    /// # Errors
    /// [`SetupError`] for a joint that is not there.
    pub fn with_law(mut self, joint: usize, along: Coordinate, law: Arc<dyn JointLaw>) -> Result<Self, SetupError> {
        let joint = self.joint_mut(joint, "the number of the joint of a law")?;
        let force = match along {
            Coordinate::Turn => &mut joint.turn_force,
            Coordinate::Slide => &mut joint.slide_force,
        };
        force.get_or_insert_default().laws.push(law);
        Ok(self)
    }

    /// The same with one more equation at a joint.
    ///
    /// # Errors
    /// [`SetupError`] for a joint that is not there.
    pub fn with_equation(mut self, joint: usize, equation: Arc<dyn JointEquation>) -> Result<Self, SetupError> {
        let joint = self.joint_mut(joint, "the number of the joint of an equation")?;
        joint.rows.push(Row::Outside(equation));
        Ok(self)
    }

    fn joint_mut(&mut self, joint: usize, what: &'static str) -> Result<&mut Joint, SetupError> {
        let refusal = SetupError::Value { what, found: joint as f64, expected: "that of a joint, from 0" };
        self.connections.joints.get_mut(joint).ok_or(refusal)
    }

    /// The bodies.
    pub fn bodies(&self) -> &[ConservativeBody] {
        &self.bodies
    }

    /// A body in a message, by its number from 0.
    pub(crate) fn named(&self, number: usize) -> BodyName {
        BodyName { number, name: self.names.get(number).cloned() }
    }

    /// The joints.
    pub fn joints(&self) -> &[Joint] {
        &self.connections.joints
    }

    /// The couplings of joints.
    pub fn couplings(&self) -> &[Coupling] {
        &self.connections.couplings
    }

    /// The forces between markers.
    pub fn elements(&self) -> &[Arc<dyn ForceElement>] {
        &self.connections.elements
    }

    /// The motion of a marker at a time as an element sees it, from the one in the frame of its body.
    pub(crate) fn motion_for(&self, element: usize, marker: &Marker, motion: MarkerMotion, time: f64) -> MarkerMotion {
        if self.connections.elements[element].is_relative() {
            return motion;
        }
        let frame = marker.body().map(|body| self.bodies[body].frame);
        let (position_global, velocity) = match frame {
            Some(frame) => (frame.global_place(&motion.position_global, time), frame.velocity()),
            None => (marker.position(), Vector3::zeros()),
        };
        MarkerMotion { position_global, velocity_global: motion.velocity_global + velocity, ..motion }
    }

    /// The radius of gyration of the body of a marker; of the ground, zero.
    pub(crate) fn length_at(&self, marker: &Marker) -> f64 {
        marker.body().map_or(0.0, |body| self.radii[body])
    }

    /// Number of coordinates of all bodies as rigid ones: point masses do not turn.
    pub(crate) fn rigid_coordinates(&self) -> usize {
        self.bodies.iter().map(|body| if body.is_point() { 3 } else { 6 }).sum()
    }

    /// Largest distance of a marker from the origin of its body.
    pub(crate) fn longest_arm(&self) -> f64 {
        let on_bodies = self.connections.markers().filter(|marker| marker.body().is_some());
        on_bodies.map(Marker::distance).fold(0.0, f64::max)
    }

    /// Largest distance of point masses at these places from the first of them, or of a marker on the ground from there; 1 where all
    /// are at one place.
    pub(crate) fn spread_of_points(&self, mut places: impl Iterator<Item = Vector3<f64>>) -> f64 {
        let first = places.next().unwrap_or_default();
        let on_ground = self.connections.markers().filter(|marker| marker.body().is_none()).map(Marker::position);
        let spread = places.chain(on_ground).map(|place| (place - first).norm()).fold(0.0, f64::max);
        if spread > 0.0 { spread } else { 1.0 }
    }

    /// Number of coordinates of all bodies.
    pub(crate) fn coordinates(&self) -> usize {
        self.first[self.bodies.len()]
    }

    /// Number of rows of all joints and couplings.
    pub(crate) fn rows(&self) -> usize {
        self.connections.rows()
    }
}

/// Refuses a marker on a body that is not there or has other modes.
fn check(marker: &Marker, bodies: &[ConservativeBody]) -> Result<(), SetupError> {
    let Some(number) = marker.body() else { return Ok(()) };
    let Some(body) = bodies.get(number) else {
        let what = "the number of a marker's body";
        return Err(SetupError::Value { what, found: number as f64, expected: "that of a body, from 0" });
    };
    let (found, expected) = (marker.coordinates(), body.coordinates());
    if found != 0 && (found != expected || marker.is_bent() != body.manifold.is_some()) {
        return Err(SetupError::Length { what: "the shapes of a marker", expected, found });
    }
    let expected = body.flexible();
    if let Some(found) = marker.least_of_second_order().filter(|found| *found < expected) {
        return Err(SetupError::Length { what: "the second order of a marker", expected, found });
    }
    Ok(())
}
