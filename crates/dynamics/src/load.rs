//! Loads on the body.
//!
//! A load is anything that implements [`Load`]. The built-in ones are [`PointForce`], [`PointMoment`] and [`FieldLoad`],
//! each in a file of its own; [`LoadFn`] makes one from a closure.

mod body_field;
mod closure;
mod field;
mod force;
mod moment;
mod scaled;
pub(crate) mod signal;

use std::any::Any;
use std::fmt;
use std::sync::Arc;

use keys::{Key, Keyed};
use nalgebra::{Matrix3, Vector3};

use crate::body::second_order::SecondOrder;
use crate::body::shapes::{PointShapes, RotationShapes, sum};
use crate::error::SetupError;
use crate::history::History;

pub use body_field::BodyField;
pub use closure::LoadFn;
pub use field::FieldLoad;
pub use force::PointForce;
pub use moment::PointMoment;
pub use scaled::ScaledLoad;

/// Something that acts on the body.
///
/// It sees the motion and adds forces and moments to what is applied. It is evaluated several times a step, so it must
/// not allocate, and it must depend on nothing but the motion, or steps would not converge.
///
/// A checkpoint knows a load by its [`key`](Self::key).
pub trait Load: fmt::Debug + Send + Sync + Any {
    /// Adds what the load does to the body in this motion.
    fn apply(&self, motion: &Kinematics, applied: &mut Applied);

    /// Times at which the load or one of its rates jumps, rising. Steps end there.
    fn discontinuities(&self) -> Vec<f64> {
        self.history().map_or_else(Vec::new, History::discontinuities)
    }

    /// Longest step that sees the load as it is, in the stretch between two discontinuities that has `branch_time` inside.
    fn longest_step(&self, branch_time: f64) -> f64 {
        self.history().map_or(f64::INFINITY, |history| history.longest_step(branch_time))
    }

    /// The factor over time, of a load that is one pattern of forces times a factor.
    fn history(&self) -> Option<&History> {
        None
    }

    /// The pattern of forces, of a load that is one pattern times its [`history`](Self::history). Estimates before a run
    /// need it; a load without one is simulated all the same.
    fn pattern(&self) -> Option<Pattern> {
        None
    }

    /// True if it does the same to the same motion at a time by the branches that hold at two branch times, whenever it is
    /// asked: what has been found with one then holds with the other. Not so what something outside sets between steps.
    fn is_same(&self, time: f64, branch_times: [f64; 2]) -> bool {
        let _ = (time, branch_times);
        false
    }

    /// Numbers in the matrices that an evaluation reads for it.
    fn matrix_entries(&self) -> usize {
        0
    }

    /// The key with the name of the law and all its numbers, by which a checkpoint knows the load: the same in every process.
    fn key(&self, key: Key) -> Key;

    /// Refuses numbers that are not finite, and shapes of another body than one with `flexible` modes.
    ///
    /// # Errors
    /// [`SetupError`].
    fn check(&self, flexible: usize) -> Result<(), SetupError> {
        let _ = flexible;
        Ok(())
    }
}

/// A load that several runs may share.
pub type SharedLoad = Arc<dyn Load>;

/// The axes that the direction of a load is fixed in.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum LoadFrame {
    /// Global axes: a dead load.
    #[default]
    Global,
    /// Body axes: a follower load that turns with the body frame.
    Body,
    /// Axes that turn with the material at the place of the load. Of a rigid body they are the body axes.
    Material,
}

/// Modal forces of a load where its history is 1, as `columnsᵀ · vector`.
#[derive(Debug, Clone)]
pub struct Pattern {
    /// A 3-vector for each mode, rigid and flexible (6+nf), body axes.
    pub columns: Vec<Vector3<f64>>,
    /// The force or moment, in the axes of `frame`.
    pub vector: Vector3<f64>,
    /// The axes that it is fixed in.
    pub frame: LoadFrame,
    /// True if the vector acts at one place. A field has one number for each mode instead, along x.
    pub local: bool,
}

/// The motion of the body that a load sees.
#[derive(Debug, Clone, Copy)]
pub struct Kinematics<'a> {
    /// Time.
    pub time: f64,
    /// The time at which the branch of a piecewise law is chosen. It is inside the step, so that both ends of a step see
    /// the law that holds in it, and not what is beyond a jump there.
    pub branch_time: f64,
    /// A: takes global components to body components.
    pub body_from_global: &'a Matrix3<f64>,
    /// Position of the body's origin, global components.
    pub origin_global: Vector3<f64>,
    /// Velocity of the body's origin, global components.
    pub origin_velocity_global: Vector3<f64>,
    /// Angular velocity of the body frame, body components.
    pub omega_body: Vector3<f64>,
    /// Origin of the frame in which the coordinates are displacements, global components: without rigid modes among them,
    /// the body's.
    pub(crate) frame_origin_global: Vector3<f64>,
    pub(crate) coordinates: Coordinates<'a>,
    /// True if histories are taken as 1.
    pub(crate) unit: bool,
}

/// A motion as displacements from an inertial frame, rigid ones included.
#[derive(Debug, Clone, Copy)]
pub struct InertialMotion<'a> {
    /// Time.
    pub time: f64,
    /// The time at which the branches of piecewise laws are chosen.
    pub branch_time: f64,
    /// Takes global components to those of the frame.
    pub body_from_global: &'a Matrix3<f64>,
    /// Where the frame's origin is, global components.
    pub frame_origin_global: Vector3<f64>,
    /// Position of the body's origin, global components.
    pub origin_global: Vector3<f64>,
    /// Velocity of the body's origin, global components.
    pub origin_velocity_global: Vector3<f64>,
    /// Angular velocity, body components.
    pub omega_body: Vector3<f64>,
    /// Displacements of all modes, rigid and flexible (6+nf).
    pub modal_displacement: &'a [f64],
    /// Velocities of all modes (6+nf).
    pub modal_velocity: &'a [f64],
}

impl<'a> InertialMotion<'a> {
    fn coordinates(&self) -> Coordinates<'a> {
        let Self { modal_displacement: displacement, modal_velocity: velocity, .. } = *self;
        Coordinates { first: 0, displacement, velocity, on_manifold: None }
    }

    /// The motion as loads see it.
    pub fn kinematics(&self) -> Kinematics<'a> {
        let Self { time, branch_time, body_from_global, frame_origin_global, .. } = *self;
        let Self { origin_global, origin_velocity_global, omega_body, .. } = *self;
        Kinematics {
            time,
            branch_time,
            body_from_global,
            origin_global,
            origin_velocity_global,
            omega_body,
            frame_origin_global,
            coordinates: self.coordinates(),
            unit: false,
        }
    }

    /// Room for what loads do to this motion, each multiplied by `weight`: moments are about the point `center_body` in the
    /// frame, and modal forces are added to `modal_force` (6+nf).
    pub fn applied(&self, center_body: Vector3<f64>, weight: f64, modal_force: &'a mut [f64]) -> Applied<'a> {
        Applied { weight, ..Applied::new(self.coordinates(), center_body, modal_force) }
    }
}

/// Modal coordinates, of all modes or of the flexible ones alone.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Coordinates<'a> {
    /// Number of the first mode: 0 where rigid modes are among them, 6 where they are not.
    pub first: usize,
    pub displacement: &'a [f64],
    pub velocity: &'a [f64],
    /// q and q̇ of the flexible modes, on a manifold of large modes, where the others are ξ and ν of the extended shapes.
    pub on_manifold: Option<[&'a [f64]; 2]>,
}

impl<'a> Coordinates<'a> {
    /// q and q̇ of the flexible modes, which displacements of second order go by.
    fn modes(&self) -> [&'a [f64]; 2] {
        let rigid = 6 - self.first;
        self.on_manifold.unwrap_or_else(|| [&self.displacement[rigid..], &self.velocity[rigid..]])
    }
}

impl Kinematics<'_> {
    /// The value of a history now.
    pub fn factor(&self, history: &History) -> f64 {
        if self.unit { 1.0 } else { history.at(self.time, self.branch_time) }
    }

    /// Body components of a vector with these components in `frame`; in axes that turn with the material, those that it has
    /// on the undeformed body.
    pub fn to_body(&self, vector: &Vector3<f64>, frame: LoadFrame) -> Vector3<f64> {
        match frame {
            LoadFrame::Global => self.body_from_global * vector,
            LoadFrame::Body | LoadFrame::Material => *vector,
        }
    }

    /// Position of a point, global components.
    pub fn position_global(&self, point: &PointShapes) -> Vector3<f64> {
        self.frame_origin_global + self.body_from_global.tr_mul(&self.arm_body(point))
    }

    /// Velocity of a point, global components.
    pub fn velocity_global(&self, point: &PointShapes) -> Vector3<f64> {
        let Coordinates { first, velocity, .. } = self.coordinates;
        let mut modal = point.components(first).sum(velocity);
        if let Some(second_order) = point.second_order() {
            let [q, rate] = self.coordinates.modes();
            modal += second_order.velocity(q, rate);
        }
        let turning = if first > 0 { self.omega_body.cross(&self.arm_body(point)) } else { Vector3::zeros() };
        let of_origin = if first > 0 { self.origin_velocity_global } else { Vector3::zeros() };
        of_origin + self.body_from_global.tr_mul(&(turning + modal))
    }

    /// Displacements of the flexible modes (nf).
    pub fn modal_displacement(&self) -> &[f64] {
        self.coordinates.modes()[0]
    }

    /// Velocities of the flexible modes (nf).
    pub fn modal_velocity(&self) -> &[f64] {
        self.coordinates.modes()[1]
    }

    /// Body components of a vector that turns with the material at a place, from those that it has on the undeformed body.
    ///
    /// The modes give w = ½ curl u, the antisymmetric part of ∇u, which of a rotation by ψ about a unit vector is sin ψ times
    /// that vector: the vector is turned by that rotation, whose length it keeps.
    pub(crate) fn turned(&self, place: &RotationShapes, vector: &Vector3<f64>) -> Vector3<f64> {
        let Coordinates { first, displacement, .. } = self.coordinates;
        let w = sum(&place.columns()[6..], &displacement[6 - first..]);
        let sine = w.norm_squared();
        let (w, cosine) = if sine < 1.0 { (w, (1.0 - sine).sqrt()) } else { (w / sine.sqrt(), 0.0) };
        vector + w.cross(vector) + w.cross(&w.cross(vector)) / (1.0 + cosine)
    }

    /// From the origin to a point of the deformed body, body components.
    fn arm_body(&self, point: &PointShapes) -> Vector3<f64> {
        let Coordinates { first, displacement, .. } = self.coordinates;
        let second_order = |second: &SecondOrder| second.displacement(self.coordinates.modes()[0]);
        point.position_body()
            + point.components(first).sum(displacement)
            + point.second_order().map_or_else(Vector3::zeros, second_order)
    }
}

/// Sum of what the loads do: their resultant, their modal forces and their power on the deformation.
#[derive(Debug)]
pub struct Applied<'a> {
    coordinates: Coordinates<'a>,
    /// The point that moments are about, from the body's origin.
    center_body: Vector3<f64>,
    /// Factor on everything that is added.
    pub(crate) weight: f64,
    /// Force, body components.
    pub force_body: Vector3<f64>,
    /// Moment, body components.
    pub moment_body: Vector3<f64>,
    /// Power of the modal forces on the modal velocities.
    pub modal_power: f64,
    /// Ψᵀf is added here, of the modes of `coordinates`.
    modal_force: &'a mut [f64],
    /// Forces on q itself, on a manifold.
    on_modes: Option<&'a mut [f64]>,
}

impl<'a> Applied<'a> {
    /// Nothing yet; modal forces are added to `modal_force`.
    pub(crate) fn new(coordinates: Coordinates<'a>, center_body: Vector3<f64>, modal_force: &'a mut [f64]) -> Self {
        let zero = Vector3::zeros();
        Self {
            coordinates,
            center_body,
            weight: 1.0,
            force_body: zero,
            moment_body: zero,
            modal_power: 0.0,
            modal_force,
            on_modes: None,
        }
    }

    /// The same on a manifold of large modes: forces on q itself are added to `on_modes`.
    pub(crate) fn on_manifold(self, on_modes: &'a mut [f64]) -> Self {
        Self { on_modes: Some(on_modes), ..self }
    }

    /// Adds a force at a point, body components.
    pub fn force(&mut self, point: &PointShapes, force_body: &Vector3<f64>) {
        let force_body = force_body * self.weight;
        if force_body == Vector3::zeros() {
            return;
        }
        let Coordinates { first, displacement, velocity, .. } = self.coordinates;
        let second_order = self.push(point.second_order(), &force_body);
        let (moved, power) = point.components(first).push(&force_body, displacement, velocity, self.modal_force);
        let arm = point.position_body() + moved + second_order - self.center_body;
        self.force_body += force_body;
        self.moment_body += arm.cross(&force_body);
        self.modal_power += power;
    }

    /// Adds a moment, body components, at a place with these rotations in the modes.
    pub fn moment(&mut self, place: &RotationShapes, moment_body: &Vector3<f64>) {
        let moment_body = moment_body * self.weight;
        if moment_body == Vector3::zeros() {
            return;
        }
        self.moment_body += moment_body;
        self.push(place.second_order(), &moment_body);
        let Coordinates { first, displacement, on_manifold, .. } = self.coordinates;
        let turn = place.patch().filter(|_| on_manifold.is_some() && first == 6);
        if let Some(forces) = turn.and_then(|turn| turn.forces(&moment_body, displacement)) {
            return self.project(forces);
        }
        let columns = &place.columns()[first..];
        self.project(columns.iter().map(|rotation| rotation.dot(&moment_body)));
    }

    /// Adds forces on many nodes, `factor` times a field that is fixed in body axes.
    pub fn field(&mut self, field: &BodyField, factor: f64) {
        let factor = factor * self.weight;
        if factor == 0.0 {
            return;
        }
        let Coordinates { first, displacement, .. } = self.coordinates;
        let force_body = field.force_body * factor;
        let flexible = &displacement[6 - first..];
        let turned = sum(&field.moment_change, flexible);
        let force_body = force_body + sum(&field.force_change, flexible) * factor;
        self.force_body += force_body;
        self.moment_body += (field.moment_body + turned) * factor - self.center_body.cross(&force_body);
        self.project(field.modal[first..].iter().map(|f| f * factor));
        let velocity = self.coordinates.velocity;
        let modal_force = &mut self.modal_force[6 - first..];
        for (column, q) in field.load_stiffness.chunks_exact(field.moment_change.len().max(1)).zip(flexible) {
            for ((f, v), change) in modal_force.iter_mut().zip(&velocity[6 - first..]).zip(column) {
                let change = change * (q * factor);
                *f += change;
                self.modal_power += change * v;
            }
        }
        self.push(field.second_order.as_ref(), &(Vector3::x() * factor));
    }

    /// Adds a modal force on one flexible mode, numbered from 0. It has no resultant.
    pub fn modal_force(&mut self, flexible_mode: usize, force: f64) {
        let [_, rate] = self.coordinates.modes();
        let modes = match &mut self.on_modes {
            Some(on_modes) => on_modes,
            None => &mut self.modal_force[6 - self.coordinates.first..],
        };
        if let (Some(f), Some(v)) = (modes.get_mut(flexible_mode), rate.get(flexible_mode)) {
            *f += force * self.weight;
            self.modal_power += force * self.weight * v;
        }
    }

    /// Adds the modal force of a force or moment on a displacement or rotation of second order, which is returned.
    fn push(&mut self, second_order: Option<&SecondOrder>, vector: &Vector3<f64>) -> Vector3<f64> {
        let Some(second_order) = second_order else { return Vector3::zeros() };
        let [q, rate] = self.coordinates.modes();
        let force = match &mut self.on_modes {
            Some(on_modes) => on_modes,
            None => &mut self.modal_force[6 - self.coordinates.first..],
        };
        let (bent, power) = second_order.push(vector, q, rate, force);
        self.modal_power += power;
        bent
    }

    /// Adds the components of a force along the modes.
    fn project(&mut self, components: impl Iterator<Item = f64>) {
        let modes = self.modal_force.iter_mut().zip(self.coordinates.velocity);
        let mut power = 0.0;
        for ((f, v), component) in modes.zip(components) {
            *f += component;
            power += component * v;
        }
        self.modal_power += power;
    }
}

/// Refuses a force or moment that is not finite, and a place of a body with fewer modes than `flexible`.
fn check_vector(
    what: &'static str,
    vector: &Vector3<f64>,
    modes: usize,
    second_order: Option<&SecondOrder>,
    flexible: usize,
) -> Result<(), SetupError> {
    if let Some(found) = second_order.map(SecondOrder::modes).filter(|found| *found < flexible) {
        return Err(SetupError::Length { what: "the geometric stiffness of a load", expected: flexible, found });
    }
    if let Some(found) = vector.iter().copied().find(|f| !f.is_finite()) {
        return Err(SetupError::Value { what, found, expected: "a finite number" });
    }
    if modes < flexible {
        return Err(SetupError::Length { what: "the point of a load", expected: flexible, found: modes });
    }
    Ok(())
}

impl Keyed for LoadFrame {
    fn key(&self, key: Key) -> Key {
        match self {
            Self::Global => "global",
            Self::Body => "body",
            Self::Material => "material",
        }
        .key(key)
    }
}
