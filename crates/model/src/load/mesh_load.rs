//! Loads of a scene: where they act on the mesh, and what that is in modal coordinates.

use std::sync::Arc;

use dynamics::{
    BodyField, Effect, FieldLoad, LoadFrame, PointForce, PointMoment, PointShapes, RotationShapes, SecondOrder,
    SharedLoad,
};
use faer::Mat;
use fem_tet10::{Location, Matrices, Mesh};
use modal::{ModalError, Modes, NodalMass};
use nalgebra::Vector3;
use reduced_body::{BodyPoint, ReducedBody};
use rigid_kin::Attitude;
use scene::{Body, Choice, Load, LoadKind, LoadPlace};

use crate::error::{BuildError, modal, refuse, refuse_mesh};
use crate::load::directed::Directed;
use crate::load::history::history;
use crate::load::rotation::Rotation;
use crate::load::turning::Turning;
use crate::model::initial::first_attitude;
use crate::needs::Needed;

/// A part of a load along or across an axis that is rounding.
const PARALLEL: f64 = 1e-12;

/// A load on the nodes of the mesh.
pub(crate) struct MeshLoad {
    /// Name for the reader.
    name: String,
    /// Action of an amplitude of 1 or −1.
    pub(crate) action: Action,
    /// Size of the amplitude.
    size: f64,
    pub history: dynamics::History,
    /// True if it keeps its direction in the body or in the material.
    pub follows: bool,
    /// How the material that its direction turns with is turned by the nodes.
    pub(crate) turning: Option<Rotation>,
    /// Degrees of freedom of a node.
    dofs: usize,
    /// Attitude of the body at the beginning.
    attitude: Attitude,
    is_gravity: bool,
}

/// Loads on a body, each with whether it is gravity.
pub(crate) struct BodyLoads {
    pub loads: Vec<SharedLoad>,
    pub is_gravity: Vec<bool>,
}

impl BodyLoads {
    /// All of them, or all but gravity.
    pub fn acting(self, with_gravity: bool) -> Vec<SharedLoad> {
        let acts = |is_gravity: &bool| with_gravity || !is_gravity;
        self.loads.into_iter().zip(&self.is_gravity).filter(|(_, g)| acts(g)).map(|(load, _)| load).collect()
    }
}

impl FromIterator<(SharedLoad, bool)> for BodyLoads {
    fn from_iter<I: IntoIterator<Item = (SharedLoad, bool)>>(loads: I) -> Self {
        let (loads, is_gravity) = loads.into_iter().unzip();
        Self { loads, is_gravity }
    }
}

/// Where a load acts, and how much.
pub(crate) enum Action {
    /// A force at the weighted mean of nodes; the weights sum to one.
    Force { nodes: Vec<u32>, weights: Vec<f64>, force: Vector3<f64> },
    /// A force on every mass: M times an acceleration of the whole body.
    Weight { weight: Arc<UnitWeight>, force: Vector3<f64> },
    /// A couple on the rotation of the material at its place.
    Moment { patch: Rotation, moment: Vector3<f64> },
    /// Forces on nodes that are fixed in the body.
    Field { nodes: Vec<u32>, forces: Vec<Vector3<f64>>, group: String, pressure: f64 },
}

/// Forces of a unit acceleration of the whole body.
pub(crate) struct UnitWeight {
    /// Forces on the unknowns, for an acceleration along each axis (N×3). In general they act on rotations, too.
    pub forces: Mat<f64>,
    pub mass: f64,
}

impl UnitWeight {
    /// By the forces themselves (N×3), or by a mass for each node (n×1).
    pub fn new(weights: Mat<f64>, dofs: usize) -> Self {
        if weights.ncols() == 1 {
            let of_node = |row: usize, axis: usize| if row % 3 == axis { weights[(row / 3, 0)] } else { 0.0 };
            let forces = Mat::from_fn(3 * weights.nrows(), 3, of_node);
            return Self { forces, mass: weights.col(0).iter().sum() };
        }
        let mass = (0..weights.nrows() / dofs).map(|node| weights[(dofs * node, 0)]).sum();
        Self { forces: weights, mass }
    }

    /// The weight of the elements of a mesh.
    pub fn of_elements(matrices: &Matrices) -> Result<Self, ModalError> {
        let masses = NodalMass::of_nodes(matrices.start(), matrices.nodes(), matrices.mass_by_nodes())?.row_sums();
        Ok(Self::new(Mat::from_fn(masses.len(), 1, |node, _| masses[node]), 3))
    }

    /// The centre of mass, which moves as the mean of all masses does: in a free body not at all.
    fn point(&self, body: &ReducedBody, modes: &Modes) -> BodyPoint {
        let position_body = body.center_of_mass - body.origin;
        if body.motion.is_free() {
            return BodyPoint { position_body, shapes: Mat::zeros(3, modes.shapes.ncols()) };
        }
        let shapes = self.forces.transpose() * modes.shapes.as_ref();
        BodyPoint { position_body, shapes: shapes * faer::Scale(1.0 / self.mass) }
    }
}

/// Change of a pressure on a surface as the surface moves in each mode.
pub(crate) struct FollowerChange {
    /// Change of the resultant and of the moment about the origin of the body (nf).
    pub force: Vec<Vector3<f64>>,
    pub moment: Vec<Vector3<f64>>,
    /// Ψᵀ ∂f/∂q (nf × nf).
    pub load_stiffness: Mat<f64>,
}

/// The loads of a scene on its mesh.
pub(crate) fn on_mesh(
    scene: &Needed<'_>,
    mesh: &Mesh,
    dofs: usize,
    weight: &Arc<UnitWeight>,
) -> Result<Vec<MeshLoad>, BuildError> {
    let attitude = first_attitude(scene);
    acting(scene)
        .map(|(i, load)| {
            let key = |name: &str| format!("loads[{i}].{name}");
            let surface = |error| refuse_mesh(scene, &key("group"), &error);
            let amplitude = load.amplitude;
            let unit = direction(load) * amplitude.signum();
            let action = match (load.kind, &load.place) {
                (LoadKind::Moment, LoadPlace::Point(at)) => {
                    Action::Moment { patch: Rotation::at(scene, mesh, dofs, &key("at"), *at)?, moment: unit }
                }
                (_, LoadPlace::Point(at)) => {
                    let Location { nodes, weights } =
                        mesh.locate(*at).map_err(|error| refuse(scene, &key("at"), error))?;
                    Action::Force { nodes, weights, force: unit }
                }
                (_, LoadPlace::Ball { at, radius }) => {
                    let mean = mesh.mean_rotation(*at, Some(*radius));
                    let patch = Rotation::Mean(mean.map_err(|error| refuse(scene, &key("radius"), error))?);
                    Action::Moment { patch, moment: unit }
                }
                (LoadKind::Pressure, LoadPlace::Surface(group)) => {
                    let (nodes, forces) = mesh.surface_pressure(group).map_err(surface)?;
                    let pressure = amplitude.signum();
                    let forces = forces.into_iter().map(|f| f * pressure).collect();
                    Action::Field { nodes, forces, group: group.clone(), pressure }
                }
                (_, LoadPlace::Surface(group)) => {
                    let (nodes, weights) = mesh.surface_weights(group).map_err(surface)?;
                    let total: f64 = weights.iter().sum();
                    let weights = weights.into_iter().map(|w| w / total).collect();
                    Action::Force { nodes, weights, force: unit * total }
                }
                (_, LoadPlace::Everywhere) => Action::Weight { weight: weight.clone(), force: unit * weight.mass },
            };
            let history = history(scene, &key("history"), &load.history)?;
            let name = name(i, load);
            let turning = match load.place {
                LoadPlace::Point(at) if load.frame == LoadFrame::Material => {
                    Some(Rotation::at(scene, mesh, dofs, &key("frame"), at)?)
                }
                _ => None,
            };
            let (follows, is_gravity) = (load.follows(), load.is_gravity());
            Ok(MeshLoad { name, action, size: amplitude.abs(), history, follows, turning, dofs, attitude, is_gravity })
        })
        .collect()
}

/// The loads of a scene on a rigid body without a mesh.
pub(crate) fn on_rigid(scene: &Needed<'_>, body: &ReducedBody) -> Result<BodyLoads, BuildError> {
    acting(scene)
        .map(|(i, load)| {
            let at = |position: [f64; 3]| {
                let position_body = Vector3::from(position) - body.origin;
                PointShapes::new(body, &BodyPoint::rigid(position_body))
            };
            let history = history(scene, &format!("loads[{i}].history"), &load.history)?;
            let vector = direction(load) * load.amplitude;
            let on_body: SharedLoad = match (load.kind, &load.place) {
                (LoadKind::Moment, LoadPlace::Point(_) | LoadPlace::Ball { .. }) => Arc::new(PointMoment {
                    rotation: RotationShapes::new(body, Mat::zeros(3, 0).as_ref()),
                    moment: vector,
                    frame: load.frame,
                    history,
                }),
                (_, LoadPlace::Point(point) | LoadPlace::Ball { at: point, .. }) => {
                    let (point, frame) = (at(*point), load.frame);
                    Arc::new(PointForce { point, force: vector, frame, turning: None, history })
                }
                (_, LoadPlace::Everywhere) => {
                    let weight = direction(load) * (load.amplitude * body.mass);
                    Arc::new(PointForce::dead(at(body.center_of_mass.into()), weight, history))
                }
                (_, LoadPlace::Surface(_)) => {
                    return Err(scene
                        .refuse(
                            &format!("loads[{i}].group"),
                            "a surface of a body without a mesh",
                            "a load on a point",
                            "give its resultant as a force and a moment, or give the body a mesh",
                        )
                        .into());
                }
            };
            Ok((on_body, load.is_gravity()))
        })
        .collect()
}

/// The loads that may act, with their numbers in the scene.
pub(crate) fn acting<'a>(scene: &Needed<'a>) -> impl Iterator<Item = (usize, &'a Load)> + use<'a> {
    let with_gravity = scene.effects.choices[Effect::Gravity] != Choice::Off;
    scene.loads.iter().enumerate().filter(move |(_, load)| with_gravity || !load.is_gravity())
}

/// The acceleration of the support that a load stands for.
#[derive(Debug, Clone)]
pub struct BaseAcceleration {
    /// Number of the load among those that act.
    pub load: usize,
    /// Where the history is 1, global components.
    acceleration_global: Vector3<f64>,
    history: dynamics::History,
}

impl BaseAcceleration {
    /// All base accelerations of a scene, whose gravity acts or not.
    pub(crate) fn of(scene: &Needed<'_>, with_gravity: bool) -> Result<Vec<Self>, BuildError> {
        let of_load = |(load, (i, of)): (usize, (usize, &Load))| {
            let acceleration_global = of.base_acceleration().into();
            let history = history(scene, &format!("loads[{i}].history"), &of.history);
            history.map(|history| Self { load, acceleration_global, history })
        };
        let acting = acting(scene).filter(|(_, load)| with_gravity || !load.is_gravity());
        acting.enumerate().filter(|(_, (_, load))| load.kind == LoadKind::BaseAcceleration).map(of_load).collect()
    }

    /// At a time, global components.
    pub fn at(&self, time: f64) -> Vector3<f64> {
        self.acceleration_global * self.history.at(time, time)
    }
}

/// Name of a load for the reader.
fn name(i: usize, load: &Load) -> String {
    let article = if load.is_gravity() { "" } else { "the " };
    format!("{article}{} loads[{i}]", load.kind.name().replace('-', " "))
}

/// The unit vector that it acts along; zero of a pressure. Every mass is pulled against the acceleration of the base.
fn direction(load: &Load) -> Vector3<f64> {
    let direction = Vector3::from(load.direction);
    if load.kind == LoadKind::BaseAcceleration { -direction } else { direction }
}

impl MeshLoad {
    pub fn is_gravity(&self) -> bool {
        self.is_gravity
    }

    /// "gravity along (0, 0, -1)", for a force or moment in body axes.
    pub fn name_along(&self, vector: &Vector3<f64>) -> String {
        let rounded = |x: f64| (x * 100.0).round() / 100.0 + 0.0;
        match vector.try_normalize(0.0) {
            Some(d) => {
                format!("{} along ({}, {}, {}) of the body", self.name, rounded(d.x), rounded(d.y), rounded(d.z))
            }
            None => self.name.clone(),
        }
    }

    /// Size of the amplitude, which multiplies what is said of a unit.
    pub(crate) fn size(&self) -> f64 {
        self.size
    }

    /// The force or moment in the first attitude, body axes, where the history is 1 and the amplitude 1 or −1; none of a field.
    pub(crate) fn unit(&self) -> Option<Vector3<f64>> {
        let is_field = matches!(self.action, Action::Field { .. });
        (!is_field).then(|| self.vector_in(&self.attitude))
    }

    /// The force or moment in body axes in an attitude, where the history is 1 and the amplitude 1 or −1; zero of a field.
    pub(crate) fn vector_in(&self, attitude: &Attitude) -> Vector3<f64> {
        match &self.action {
            Action::Force { force: vector, .. }
            | Action::Weight { force: vector, .. }
            | Action::Moment { moment: vector, .. } => {
                if self.follows {
                    *vector
                } else {
                    attitude.to_body(vector)
                }
            }
            Action::Field { .. } => Vector3::zeros(),
        }
    }

    /// Forces or moments of the same size, in body axes, whose combinations are all that a dead load of an amplitude of 1 may
    /// become as the body turns; none where it keeps its direction in the body.
    pub(crate) fn turned(&self, turning: Turning) -> Vec<Vector3<f64>> {
        let turns = (!self.follows || self.turning.is_some()) && self.size > 0.0;
        let Some(vector) = self.unit().filter(|v| turns && v.norm() > 0.0) else { return Vec::new() };
        let size = vector.norm();
        let turning = if self.turning.is_some() { Turning::Freely } else { turning };
        match turning {
            Turning::Not => Vec::new(),
            Turning::Freely => [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| axis * size).into(),
            Turning::About(axis) => {
                let along = axis * axis.dot(&vector);
                let across = vector - along;
                let mut turned = Vec::new();
                if across.norm() > PARALLEL * size {
                    let across = across.normalize() * size;
                    turned.extend([across, axis.cross(&across)]);
                }
                if along.norm() > PARALLEL * size {
                    turned.push(axis * size);
                }
                turned
            }
        }
    }

    /// The same in global axes, of a load that keeps its direction there; none of one that does so in the body.
    pub(crate) fn dead_unit(&self) -> Option<Vector3<f64>> {
        self.unit().filter(|_| !self.follows).map(|unit| self.attitude.to_global(&unit))
    }

    /// The parts of the load in its first attitude along `turned`, relative to them: one whole part without any.
    pub(crate) fn parts(&self, turned: &[Vector3<f64>]) -> Vec<f64> {
        match self.unit() {
            Some(unit) if !turned.is_empty() => turned.iter().map(|t| t.dot(&unit) / t.norm_squared()).collect(),
            _ => vec![1.0],
        }
    }

    /// The forces on the nodes of the undeformed body in its first attitude, where the history is 1 and the amplitude 1 or −1
    /// (3n); with `vector`, of that force or moment in place of the load's own.
    pub(crate) fn add_unit_nodal_forces(&self, vector: Option<Vector3<f64>>, mut forces: faer::ColMut<'_, f64>) {
        let vector = vector.or(self.unit()).unwrap_or_default();
        let mut add = |node: u32, force: &Vector3<f64>| {
            for axis in 0..3 {
                forces[self.dofs * node as usize + axis] += force[axis];
            }
        };
        match &self.action {
            Action::Force { nodes, weights, .. } => {
                nodes.iter().zip(weights).for_each(|(node, w)| add(*node, &(vector * *w)));
            }
            Action::Weight { weight, .. } => {
                for axis in 0..3 {
                    let acceleration = vector[axis] / weight.mass;
                    for row in 0..weight.forces.nrows() {
                        forces[row] += acceleration * weight.forces[(row, axis)];
                    }
                }
            }
            Action::Moment { patch, .. } => patch.add_unit_nodal_forces(self.dofs, &vector, forces),
            Action::Field { nodes, forces, .. } => nodes.iter().zip(forces).for_each(|(node, f)| add(*node, f)),
        }
    }

    /// Adds the forces on the nodes of the undeformed body in its first attitude, where the history is 1 (3n).
    pub(crate) fn add_nodal_forces(&self, forces: &mut [f64]) {
        let mut unit = vec![0.0; forces.len()];
        self.add_unit_nodal_forces(None, faer::ColMut::from_slice_mut(&mut unit));
        forces.iter_mut().zip(unit).for_each(|(sum, force)| *sum += self.size() * force);
    }

    /// Change of a pressure as its surface moves; none of other loads.
    pub(crate) fn follower_change(
        &self,
        body: &Body,
        mesh: &Mesh,
        reduced: &ReducedBody,
        modes: &Modes,
    ) -> Result<Option<FollowerChange>, BuildError> {
        let Action::Field { nodes, forces, group, pressure } = &self.action else { return Ok(None) };
        let nf = reduced.flexible();
        let mut change = FollowerChange {
            force: vec![Vector3::zeros(); nf],
            moment: vec![Vector3::zeros(); nf],
            load_stiffness: Mat::zeros(nf, nf),
        };
        for k in 0..nf {
            let (_, changes) = mesh
                .surface_pressure_change(group, modes.shapes.col(k))
                .map_err(|error| refuse_mesh(body, "loads", &error))?;
            for ((node, force), added) in nodes.iter().zip(forces).zip(&changes) {
                let added = added * (*pressure * self.size);
                let position = Vector3::from(mesh.positions()[*node as usize]) - reduced.origin;
                change.force[k] += added;
                change.moment[k] += self.shape(modes, *node, k).cross(&(force * self.size)) + position.cross(&added);
                for a in 0..nf {
                    change.load_stiffness[(a, k)] += self.shape(modes, *node, a).dot(&added);
                }
            }
        }
        Ok(Some(change))
    }

    /// The load on the modes of a body, with the stiffness by its stress. A pressure turns with its surface: its resultant does
    /// always, what it does along the modes where `has_load_stiffness` says so. The `positions` are those of the nodes in the body
    /// that the modes are about.
    pub(crate) fn reduced(
        &self,
        body: &Body,
        (mesh, positions): (&Mesh, &[[f64; 3]]),
        reduced: &ReducedBody,
        modes: &Modes,
        stress: &[Directed],
        has_load_stiffness: bool,
    ) -> Result<SharedLoad, BuildError> {
        let frame = if self.follows { LoadFrame::Body } else { LoadFrame::Global };
        let nf = reduced.flexible();
        let history = self.history.clone();
        let second_order = || -> Result<Option<SecondOrder>, BuildError> {
            if stress.is_empty() {
                return Ok(None);
            }
            let of_unit = |directed: &Directed| {
                let size = directed.vector.norm();
                (directed.vector / size, &directed.stiffness * faer::Scale(1.0 / size))
            };
            Ok(Some(SecondOrder::new(stress.iter().map(of_unit).collect())?))
        };
        let at = |point: &BodyPoint, force: Vector3<f64>| -> Result<SharedLoad, BuildError> {
            let point = PointShapes::new(reduced, point);
            let point = match second_order()? {
                Some(second_order) => point.with_second_order(second_order),
                None => point,
            };
            let turning = self.turning.as_ref().map(|patch| patch.shapes(self.dofs, reduced, modes));
            let frame = if turning.is_some() { LoadFrame::Material } else { frame };
            Ok(Arc::new(PointForce { point, force, frame, turning, history: self.history.clone() }))
        };
        Ok(match &self.action {
            Action::Force { nodes, weights, force } => {
                let point = modes.point(positions, nodes, weights).map_err(modal(body))?;
                at(&point, force * self.size)?
            }
            Action::Weight { weight, force } => at(&weight.point(reduced, modes), force * self.size)?,
            Action::Moment { patch, moment } => {
                let rotation = patch.shapes(self.dofs, reduced, modes);
                let rotation = match second_order()? {
                    Some(second_order) => rotation.with_second_order(second_order),
                    None => rotation,
                };
                let rotation = rotation.with_patch(patch.patch_turn(mesh, self.dofs, modes, None));
                Arc::new(PointMoment { rotation, moment: moment * self.size, frame, history })
            }
            Action::Field { nodes, forces, .. } => {
                let position = |node: u32| Vector3::from(mesh.positions()[node as usize]) - reduced.origin;
                let acting = || nodes.iter().copied().zip(forces.iter().map(|force| force * self.size));
                let force_body: Vector3<f64> = acting().map(|(_, f)| f).sum();
                let moment_body: Vector3<f64> = acting().map(|(node, f)| position(node).cross(&f)).sum();
                let rigid =
                    [reduced.translation_basis.tr_mul(&force_body), reduced.rotation_basis.tr_mul(&moment_body)];
                let flexible = (0..nf).map(|k| acting().map(|(node, f)| self.shape(modes, node, k).dot(&f)).sum());
                let modal = rigid.iter().flat_map(|v| v.iter().copied()).chain(flexible).collect();
                let change = self.follower_change(body, mesh, reduced, modes)?;
                let load_stiffness = change.as_ref().filter(|_| has_load_stiffness).map_or(Vec::new(), |change| {
                    change.load_stiffness.col_iter().flat_map(|c| c.iter().copied().collect::<Vec<_>>()).collect()
                });
                let of_field = |directed: &Directed| SecondOrder::new(vec![(Vector3::x(), directed.stiffness.clone())]);
                let second_order = stress.first().map(of_field).transpose()?;
                let (force_change, moment_change) = match change {
                    Some(change) => (change.force, change.moment),
                    None => (Vec::new(), vec![Vector3::zeros(); nf]),
                };
                let field = BodyField {
                    force_body,
                    moment_body,
                    modal,
                    force_change,
                    moment_change,
                    load_stiffness,
                    second_order,
                };
                Arc::new(FieldLoad { field, history })
            }
        })
    }

    /// Displacement of a node in a flexible mode.
    fn shape(&self, modes: &Modes, node: u32, k: usize) -> Vector3<f64> {
        Vector3::from_fn(|axis, _| modes.shapes[(self.dofs * node as usize + axis, k)])
    }
}
