//! From a scene to a body that can move.

mod history;
mod loads;
mod physics;
mod support;

use std::time::{Duration, Instant};

use faer::Mat;
use fem_tet10::{AssemblyError, Location, Matrices, Mesh, MeshError, assemble, read_msh, reduced_geometric_stiffness};
use frames_rk4::{
    ConservativeScheme, Initial, Load, Physics, PointShapes, Rows, Setup, SetupError, Simulation, StepControl,
};
use modal::{BodyPoint, ModalError, Modes, ReducedBody, Solver, Support, centrifugal_fields};
use nalgebra::{Matrix3, Vector3};

use crate::effects::Choice;
use crate::error::SceneError;
use crate::scene::{self, Body, MeshedBody, Scene};
use loads::MeshLoad;

/// A scene that cannot be built.
#[derive(Debug, thiserror::Error)]
pub enum BuildError {
    /// Something in the scene does not fit the mesh.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The mesh cannot be used.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The matrices cannot be assembled.
    #[error(transparent)]
    Assembly(#[from] AssemblyError),
    /// The modes cannot be found.
    #[error(transparent)]
    Modal(#[from] ModalError),
}

/// How far the building of a model has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BuildProgress {
    /// The mesh is being read.
    Mesh,
    /// Mass and stiffness are being assembled.
    Assembly,
    /// The modes are being searched.
    Modes(modal::Progress),
    /// Static answers to loads and to the centrifugal field are being computed.
    Statics,
}

/// Where the time went. That of the modes is in [`modal::SolveStats`].
#[derive(Debug, Clone, Copy, Default)]
pub struct BuildTimes {
    /// Reading and checking the mesh.
    pub mesh: Duration,
    /// Assembling mass and stiffness.
    pub assembly: Duration,
    /// Finding the modes.
    pub modes: Duration,
    /// Static answers and the stress stiffness of the centrifugal field and of steady loads.
    pub statics: Duration,
    /// Making the reduced body and its points.
    pub reduction: Duration,
}

/// The finite-element side of a body.
#[derive(Debug, Clone)]
pub struct Meshed {
    /// The mesh.
    pub mesh: Mesh,
    /// Bytes that the mass and stiffness matrices took.
    pub matrix_bytes: usize,
    /// Rigid and flexible modes on the mesh.
    pub modes: Modes,
}

/// The body of a scene in modal coordinates, with its mesh, its points and its loads.
#[derive(Debug)]
pub struct Model {
    /// Mesh and modes; `None` for a rigid body without a mesh.
    pub meshed: Option<Meshed>,
    /// The reduced body.
    pub body: ReducedBody,
    /// What of the physics is computed.
    pub physics: Physics,
    /// The points whose motion is written out, by name.
    pub points: Vec<(String, PointShapes)>,
    /// R, P, Q from the origin of the body, body axes.
    pub reference_points: [Vector3<f64>; 3],
    /// Where the time went.
    pub times: BuildTimes,
    loads: Vec<Load>,
    damping_ratios: Vec<f64>,
}

impl Model {
    /// Reads the mesh of a scene, finds its modes and reduces the body. `progress` hears what is being done.
    ///
    /// # Errors
    /// [`BuildError`]: what the mesh, the materials or the modes refuse, with the place in the scene file where
    /// there is one.
    pub fn build(scene: &Scene, progress: impl FnMut(BuildProgress)) -> Result<Self, BuildError> {
        match &scene.body {
            Body::Meshed(meshed) => Self::meshed(scene, meshed, progress),
            Body::Rigid(rigid) => Self::rigid(scene, rigid),
        }
    }

    fn meshed(scene: &Scene, meshed: &MeshedBody, mut progress: impl FnMut(BuildProgress)) -> Result<Self, BuildError> {
        let mut times = BuildTimes::default();
        progress(BuildProgress::Mesh);
        let mesh = timed(&mut times.mesh, || read_mesh(scene, meshed))?;
        progress(BuildProgress::Assembly);
        let matrices = timed(&mut times.assembly, || matrices(scene, meshed, &mesh))?;
        let (support, drive) = support::support(scene, Some(&mesh))?;
        let requested = match scene.effects.flexibility {
            Choice::Off => 0,
            Choice::On | Choice::Auto => scene.modes.flexible.most(),
        };
        let solver = Solver::new(matrices.stiffness(), matrices.mass(), mesh.positions(), &support)?;
        let mut modes = timed(&mut times.modes, || {
            solver.modes(requested, |p| progress(BuildProgress::Modes(p))).map_err(|error| too_many_modes(scene, error))
        })?;
        let loads = loads::on_mesh(scene, &mesh, &solver.nodal_mass().row_sums())?;
        progress(BuildProgress::Statics);
        let statics_started = Instant::now();
        let materials = materials(meshed);
        if scene.modes.static_correction == Choice::On && requested > 0 {
            let mut fields = nodal_forces(&loads, mesh.positions().len());
            if physics::may_spin(scene, &support, drive.as_ref()) {
                let of_spin = centrifugal_fields(solver.nodal_mass(), mesh.positions(), &modes.rigid.origin);
                fields = Mat::from_fn(fields.nrows(), fields.ncols() + of_spin.ncols(), |i, j| {
                    if j < fields.ncols() { fields[(i, j)] } else { of_spin[(i, j - fields.ncols())] }
                });
            }
            let answers = solver.static_response(fields.as_ref())?;
            modes = solver.with_static_shapes(modes, answers.as_ref())?;
        }
        times.statics = statics_started.elapsed();
        let started = Instant::now();
        let mut body = ReducedBody::new(&modes, matrices.mass(), mesh.positions())?;
        times.reduction = started.elapsed();
        let statics_started = Instant::now();
        let stiffening = physics::stiffening(scene, &body, drive.as_ref(), &support);
        if stiffening {
            let fields = centrifugal_fields(solver.nodal_mass(), mesh.positions(), &body.origin);
            let answers = solver.static_response(fields.as_ref())?;
            let stiffness = reduced_geometric_stiffness(&mesh, &materials, answers.as_ref(), modes.shapes.as_ref())?;
            body.stress_stiffness = stiffness.try_into().ok();
        }
        let steady: Vec<&MeshLoad> =
            loads.iter().filter(|load| physics::stiffens(scene, &body, drive.as_ref(), load)).collect();
        let load_stiffness = if steady.is_empty() {
            None
        } else {
            let mut field = Mat::zeros(3 * mesh.positions().len(), 1);
            steady.iter().for_each(|load| load.add_nodal_forces(field.as_mut().col_mut(0)));
            let answer = solver.static_response(field.as_ref())?;
            reduced_geometric_stiffness(&mesh, &materials, answer.as_ref(), modes.shapes.as_ref())?.pop()
        };
        times.statics += statics_started.elapsed();

        let started = Instant::now();
        let point = |key: String, at: [f64; 3]| -> Result<PointShapes, SceneError> {
            let Location { nodes, weights } = mesh.locate(at).map_err(|error| refuse(scene, &key, error))?;
            Ok(PointShapes::new(&body, &BodyPoint::new(&modes, mesh.positions(), &nodes, &weights)))
        };
        let points = output_points(scene, point)?;
        let reduced_loads = loads.iter().map(|load| load.reduced(&body, &modes, &mesh)).collect();
        let reference_points = match scene.frame {
            Some(scene::Frame { r, p, q }) => [r, p, q],
            None => well_spread(mesh.positions(), &body.center_of_mass),
        }
        .map(|x| Vector3::from(x) - body.origin);
        times.reduction += started.elapsed();
        drop(solver);
        Ok(Self {
            physics: Physics { effects: physics::effects(scene, stiffening), drive, load_stiffness },
            damping_ratios: damping_ratios(scene, &body),
            meshed: Some(Meshed { matrix_bytes: matrices.bytes(), mesh, modes }),
            body,
            points,
            reference_points,
            times,
            loads: reduced_loads,
        })
    }

    fn rigid(scene: &Scene, rigid: &scene::RigidBody) -> Result<Self, BuildError> {
        let (Support { motion, .. }, drive) = support::support(scene, None)?;
        let center = Vector3::from(rigid.center_of_mass);
        let about_center = Matrix3::from_fn(|i, j| rigid.inertia[i][j]);
        let origin = motion.fixed_point().unwrap_or(center);
        let arm = center - origin;
        let inertia = about_center + (Matrix3::identity() * arm.norm_squared() - arm * arm.transpose()) * rigid.mass;
        let body = ReducedBody::rigid(rigid.mass, center, inertia, motion)?;
        let point = |_: String, at: [f64; 3]| -> Result<PointShapes, SceneError> {
            let position_body = Vector3::from(at) - body.origin;
            Ok(PointShapes::new(&body, &BodyPoint { position_body, shapes: Mat::zeros(3, 0) }))
        };
        let points = output_points(scene, point)?;
        let reference_points = match scene.frame {
            Some(scene::Frame { r, p, q }) => [r, p, q].map(|x| Vector3::from(x) - body.origin),
            None => [Vector3::zeros(), Vector3::x(), Vector3::y()],
        };
        Ok(Self {
            meshed: None,
            physics: Physics { effects: physics::effects(scene, false), drive, load_stiffness: None },
            points,
            reference_points,
            times: BuildTimes::default(),
            loads: loads::on_rigid(scene, &body)?,
            damping_ratios: Vec::new(),
            body,
        })
    }

    /// Frequencies of the flexible modes, cycles per time.
    pub fn natural_frequencies(&self) -> Vec<f64> {
        self.body.circular_frequencies.iter().map(|omega| omega / std::f64::consts::TAU).collect()
    }

    /// The same body with its first `flexible` modes only.
    pub fn truncated(&self, flexible: usize) -> Self {
        let flexible = flexible.min(self.body.flexible());
        let meshed = self.meshed.as_ref().map(|meshed| {
            let mut modes = meshed.modes.clone();
            modes.eigenvalues.truncate(flexible);
            modes.residuals.truncate(flexible);
            modes.force_residuals.truncate(flexible);
            modes.shapes = meshed.modes.shapes.get(.., ..flexible).to_owned();
            Meshed { mesh: meshed.mesh.clone(), modes, ..*meshed }
        });
        let stiffness = self.physics.load_stiffness.as_ref();
        let physics = Physics {
            load_stiffness: stiffness.map(|k| k.get(..flexible, ..flexible).to_owned()),
            ..self.physics.clone()
        };
        Self {
            meshed,
            physics,
            body: self.body.truncated(flexible),
            points: self.points.iter().map(|(name, point)| (name.clone(), point.truncated(flexible))).collect(),
            loads: self.loads.iter().map(|load| load.truncated(flexible)).collect(),
            damping_ratios: self.damping_ratios[..flexible].to_vec(),
            ..*self
        }
    }

    /// Damping ratio of each flexible mode.
    pub fn damping_ratios(&self) -> &[f64] {
        &self.damping_ratios
    }

    /// The loads, at their points of the body.
    pub fn loads(&self) -> &[Load] {
        &self.loads
    }

    /// The motion of a scene from its beginning.
    ///
    /// # Errors
    /// [`SetupError`], e.g. a step beyond the stability limit.
    pub fn start(&self, scene: &Scene) -> Result<Simulation, SetupError> {
        let control = match scene.time.stepping {
            scene::Stepping::Step(step) => StepControl::Fixed(step),
            scene::Stepping::Tolerance(tolerance) => StepControl::Tolerance(tolerance),
        };
        let rows = match scene.output.rows {
            scene::Rows::EverySteps(steps) => Rows::EverySteps(steps),
            scene::Rows::Interval(interval) => Rows::Interval(interval),
        };
        self.start_with(scene, method(scene.time.method), control, rows)
    }

    /// The motion of a scene by another method, in other steps or with other rows than its own.
    ///
    /// # Errors
    /// As [`Model::start`].
    pub fn start_with(
        &self,
        scene: &Scene,
        method: frames_rk4::Method,
        control: StepControl,
        rows: Rows,
    ) -> Result<Simulation, SetupError> {
        let padded = |list: &[f64]| (0..self.body.flexible()).map(|k| list.get(k).copied().unwrap_or(0.0)).collect();
        let initial = Initial {
            velocity: scene.initial.velocity.into(),
            omega: scene.initial.angular_velocity.into(),
            modal_displacement: padded(&scene.initial.modal_displacement),
            modal_velocity: padded(&scene.initial.modal_velocity),
        };
        let points: Vec<PointShapes> = self.points.iter().map(|(_, point)| point.clone()).collect();
        Simulation::new(&Setup {
            body: &self.body,
            damping_ratios: &self.damping_ratios,
            loads: &self.loads,
            physics: &self.physics,
            reference_points: self.reference_points,
            initial: &initial,
            method,
            control,
            end: scene.time.end,
            rows,
            points: &points,
        })
    }
}

/// The method that a scene names.
pub fn method(method: scene::Method) -> frames_rk4::Method {
    use frames_rk4::Method;
    match method {
        scene::Method::Paper => Method::Paper,
        scene::Method::PaperRkmk4 => Method::PaperRkmk4,
        scene::Method::Rkmk4 => Method::Conservative(ConservativeScheme::Rkmk4),
        scene::Method::Exponential => Method::Conservative(ConservativeScheme::Exponential),
        scene::Method::Strang => Method::Conservative(ConservativeScheme::Strang),
    }
}

impl Scene {
    /// Mass properties with each element's mass at its centroid, as the paper prints them.
    ///
    /// # Errors
    /// As [`Model::build`], for materials and point masses.
    pub fn centroid_lumped_inertia(&self, mesh: &Mesh) -> Result<Option<fem_tet10::LumpedInertia>, BuildError> {
        match &self.body {
            Body::Meshed(body) => {
                Ok(Some(fem_tet10::centroid_lumped_inertia(mesh, &materials(body), &point_masses(body))?))
            }
            Body::Rigid(_) => Ok(None),
        }
    }
}

/// The materials in the words of fem-tet10.
fn materials(body: &MeshedBody) -> fem_tet10::Materials {
    let material = |m: &scene::Material| fem_tet10::Material {
        young_modulus: m.young_modulus,
        poisson_ratio: m.poisson_ratio,
        density: m.density,
    };
    match &body.materials {
        scene::Materials::Whole(m) => fem_tet10::Materials::Uniform(material(m)),
        scene::Materials::ByGroup(groups) => {
            fem_tet10::Materials::ByGroup(groups.iter().map(|(name, m)| (name.clone(), material(m))).collect())
        }
    }
}

fn point_masses(body: &MeshedBody) -> Vec<fem_tet10::PointMass> {
    let point_mass = |p: &scene::PointMass| fem_tet10::PointMass { at: p.at, mass: p.mass, spread: p.spread };
    body.point_masses.iter().map(point_mass).collect()
}

fn output_points(
    scene: &Scene,
    point: impl Fn(String, [f64; 3]) -> Result<PointShapes, SceneError>,
) -> Result<Vec<(String, PointShapes)>, BuildError> {
    let named = scene.output.points.iter();
    named.map(|(name, at)| Ok((name.clone(), point(format!("output.points.{name}"), *at)?))).collect()
}

/// The forces of each load on the nodes, side by side (3n × loads).
fn nodal_forces(loads: &[MeshLoad], nodes: usize) -> Mat<f64> {
    let mut forces = Mat::zeros(3 * nodes, loads.len());
    for (i, load) in loads.iter().enumerate() {
        load.add_nodal_forces(forces.as_mut().col_mut(i));
    }
    forces
}

/// One damping ratio for each flexible mode.
fn damping_ratios(scene: &Scene, body: &ReducedBody) -> Vec<f64> {
    let frequencies = body.circular_frequencies.iter().enumerate();
    match scene.effects.damping {
        Choice::Off => vec![0.0; body.flexible()],
        Choice::On | Choice::Auto => frequencies.map(|(k, omega)| scene.modes.damping.ratio(k, *omega)).collect(),
    }
}

fn timed<T>(time: &mut Duration, work: impl FnOnce() -> T) -> T {
    let started = Instant::now();
    let result = work();
    *time = started.elapsed();
    result
}

fn read_mesh(scene: &Scene, body: &MeshedBody) -> Result<Mesh, BuildError> {
    read_msh(&body.mesh).map_err(|error| match error {
        MeshError::Io { source_name, source } => scene
            .refuse(
                "body.mesh",
                format!("a mesh that cannot be read: {source_name}: {source}"),
                "a MSH 4.1 file, its path relative to the folder of the scene file",
                "correct the path, or make the mesh: gmsh -3 -order 2 -format msh41 BODY.geo",
            )
            .into(),
        other => other.into(),
    })
}

fn matrices(scene: &Scene, body: &MeshedBody, mesh: &Mesh) -> Result<Matrices, BuildError> {
    assemble(mesh, &materials(body), &point_masses(body)).map_err(|error| {
        let at = match &error {
            AssemblyError::OffBody { at, .. } | AssemblyError::Spread { at, .. } => *at,
            AssemblyError::MissingGroup { group, .. } => {
                let key = format!("body.materials.{group}");
                return refuse(scene, &key, error).into();
            }
            _ => return error.into(),
        };
        match body.point_masses.iter().position(|p| p.at == at) {
            Some(i) => refuse(scene, &format!("body.point_masses[{i}].at"), error).into(),
            None => error.into(),
        }
    })
}

/// An assembly error at its place in the scene file.
fn refuse(scene: &Scene, key: &str, error: AssemblyError) -> SceneError {
    let message = error.to_string();
    match error {
        AssemblyError::OffBody { source_name, node, position, distance, .. } => {
            // A coordinate that is zero but for rounding is shown as zero.
            let size = Vector3::from(position).norm();
            let shown = position.map(|c| if c.abs() < 1e-9 * size { 0.0 } else { c });
            scene.refuse(
                key,
                format!("a point that is not on the body: the nearest node of {source_name} is {distance:.6} away"),
                "a point of the body",
                format!("use a point of the body; its node {node} is at {shown:?}"),
            )
        }
        AssemblyError::Spread { radius, count, distance, .. } => scene.refuse(
            key,
            format!("{count} node(s) within {radius}, the nearest {distance:.6} away"),
            "nodes all around the point that can carry the mass",
            "use a larger spread, or leave it out for a point of the body",
        ),
        AssemblyError::Patch { radius, count, distance, .. } => scene.refuse(
            key,
            format!("{count} node(s) within {radius}, the nearest {distance:.6} away"),
            "three nodes or more, not on a line, that can take the moment",
            "use a larger radius, or leave it out for a point of the body",
        ),
        AssemblyError::MissingGroup { group, present, .. } => scene.refuse(
            key,
            format!("the physical volume \"{group}\", which the mesh has not"),
            format!("one of {present:?}"),
            "rename it, or name the volume in the geometry and mesh again",
        ),
        _ => scene.refuse(key, message, "something that fits the mesh", "correct it"),
    }
}

/// A mesh error, such as a group that is not there, at its place in the scene file.
fn refuse_mesh(scene: &Scene, key: &str, error: &MeshError) -> BuildError {
    scene
        .refuse(key, error.to_string(), "something that the mesh has", "name it in the geometry, and mesh again")
        .into()
}

fn too_many_modes(scene: &Scene, error: ModalError) -> BuildError {
    match error {
        ModalError::TooManyModes { requested, available } => scene
            .refuse(
                "modes.flexible",
                requested.to_string(),
                format!("at most {available}: three modes for each node of the mesh, less the six rigid ones"),
                "ask for fewer modes, or use a finer mesh",
            )
            .into(),
        other => other.into(),
    }
}

/// Three nodes that lie far from each other: R farthest from the centre of mass, P farthest from R, Q farthest from
/// the line RP.
fn well_spread(positions: &[[f64; 3]], center_of_mass: &Vector3<f64>) -> [[f64; 3]; 3] {
    let farthest = |distance: &dyn Fn(&Vector3<f64>) -> f64| {
        positions.iter().map(|x| Vector3::from(*x)).fold((Vector3::zeros(), f64::NEG_INFINITY), |best, x| {
            let d = distance(&x);
            if d > best.1 { (x, d) } else { best }
        })
    };
    let (r, _) = farthest(&|x| (x - center_of_mass).norm());
    let (p, _) = farthest(&|x| (x - r).norm());
    let (q, _) = farthest(&|x| (x - r).cross(&(p - r)).norm());
    [r.into(), p.into(), q.into()]
}
