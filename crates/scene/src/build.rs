//! From a scene to a body that can move.

use std::time::{Duration, Instant};

use fem_tet10::{AssemblyError, Location, Matrices, Mesh, MeshError, assemble, read_msh};
use frames_rk4::{
    ConservativeScheme, DeadForce, Initial, PointShapes, Rows, Setup, SetupError, Simulation, StepControl,
};
use modal::{BodyPoint, ModalError, Modes, ReducedBody};
use nalgebra::Vector3;

use crate::error::SceneError;
use crate::history::History;
use crate::load::{Load, LoadFrame};
use crate::scene::{self, Body, MeshedBody, Scene};

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
    /// Making the reduced body and its points.
    pub reduction: Duration,
}

/// The body of a scene in modal coordinates, with its mesh, its points and its loads.
#[derive(Debug)]
pub struct Model {
    /// The mesh.
    pub mesh: Mesh,
    /// Bytes that the mass and stiffness matrices took.
    pub matrix_bytes: usize,
    /// Rigid and flexible modes on the mesh.
    pub modes: Modes,
    /// The reduced body.
    pub body: ReducedBody,
    /// The points whose motion is written out, by name.
    pub points: Vec<(String, PointShapes)>,
    /// R, P, Q from the centre of mass, body axes.
    pub reference_points: [Vector3<f64>; 3],
    /// Where the time went.
    pub times: BuildTimes,
    loads: Vec<DeadForce>,
    damping_ratios: Vec<f64>,
}

impl Model {
    /// Reads the mesh of a scene, finds its modes and reduces the body. `progress` hears what is being done.
    ///
    /// # Errors
    /// [`BuildError`]: what the mesh, the materials or the modes refuse, with the place in the scene file where
    /// there is one.
    pub fn build(scene: &Scene, mut progress: impl FnMut(BuildProgress)) -> Result<Self, BuildError> {
        let mut times = BuildTimes::default();
        progress(BuildProgress::Mesh);
        if scene.constraint.is_some() {
            let cure = "remove it, or use a later version";
            return Err(scene.refuse("constraints", "a constraint", "a free body in this version", cure).into());
        }
        let described = meshed(scene)?;
        let mesh = timed(&mut times.mesh, || read_mesh(scene, described))?;
        progress(BuildProgress::Assembly);
        let matrices = timed(&mut times.assembly, || matrices(scene, described, &mesh))?;
        let modes = timed(&mut times.modes, || {
            modal::solve(matrices.stiffness(), matrices.mass(), mesh.positions(), scene.modes.flexible.most(), |p| {
                progress(BuildProgress::Modes(p));
            })
            .map_err(|error| too_many_modes(scene, error))
        })?;
        let started = Instant::now();
        let body = ReducedBody::new(&modes, matrices.mass(), mesh.positions())?;
        let point = |key: String, at: [f64; 3]| -> Result<PointShapes, SceneError> {
            let Location { nodes, weights } = mesh.locate(at).map_err(|error| refuse(scene, &key, error))?;
            Ok(PointShapes::new(&body, &BodyPoint::new(&modes, mesh.positions(), &nodes, &weights)))
        };
        let points = scene
            .output
            .points
            .iter()
            .map(|(name, at)| Ok((name.clone(), point(format!("output.points.{name}"), *at)?)))
            .collect::<Result<_, SceneError>>()?;
        let loads = scene
            .loads
            .iter()
            .enumerate()
            .map(|(i, load)| {
                let not_yet = |key: &str, what: &str| {
                    let key = format!("loads[{i}].{key}");
                    let expected =
                        "a force in global axes with a half-sine history, which is all this version simulates";
                    scene.refuse(&key, what, expected, "change the load, or use a later version")
                };
                let Load::Force(force) = load else { return Err(not_yet("kind", "another load")) };
                let History::HalfSine { start, duration } = force.history else {
                    return Err(not_yet("history", "another history"));
                };
                if force.frame != LoadFrame::Global {
                    return Err(not_yet("frame", "a follower force"));
                }
                Ok(DeadForce {
                    point: point(format!("loads[{i}].at"), force.at)?,
                    force_global: Vector3::from(force.direction) * force.amplitude,
                    history: frames_rk4::History::HalfSine { start, duration },
                })
            })
            .collect::<Result<_, SceneError>>()?;
        let reference_points = match scene.frame {
            Some(scene::Frame { r, p, q }) => [r, p, q],
            None => well_spread(mesh.positions(), &body.center_of_mass),
        }
        .map(|x| Vector3::from(x) - body.center_of_mass);
        times.reduction = started.elapsed();
        Ok(Self {
            matrix_bytes: matrices.bytes(),
            damping_ratios: damping_ratios(scene, &modes),
            mesh,
            modes,
            body,
            points,
            reference_points,
            times,
            loads,
        })
    }

    /// The same body with its first `flexible` modes only.
    pub fn truncated(&self, flexible: usize) -> Self {
        let flexible = flexible.min(self.body.flexible());
        let mut modes = self.modes.clone();
        modes.eigenvalues.truncate(flexible);
        modes.residuals.truncate(flexible);
        modes.force_residuals.truncate(flexible);
        modes.shapes = self.modes.shapes.get(.., ..flexible).to_owned();
        let truncated = |load: &DeadForce| DeadForce { point: load.point.truncated(flexible), ..load.clone() };
        Self {
            mesh: self.mesh.clone(),
            modes,
            body: self.body.truncated(flexible),
            points: self.points.iter().map(|(name, point)| (name.clone(), point.truncated(flexible))).collect(),
            loads: self.loads.iter().map(truncated).collect(),
            damping_ratios: self.damping_ratios[..flexible].to_vec(),
            ..*self
        }
    }

    /// Damping ratio of each flexible mode.
    pub fn damping_ratios(&self) -> &[f64] {
        &self.damping_ratios
    }

    /// The loads, at their points of the body.
    pub fn loads(&self) -> &[DeadForce] {
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

impl MeshedBody {
    /// The materials in the words of fem-tet10.
    fn fem_materials(&self) -> fem_tet10::Materials {
        let material = |m: &scene::Material| fem_tet10::Material {
            young_modulus: m.young_modulus,
            poisson_ratio: m.poisson_ratio,
            density: m.density,
        };
        match &self.materials {
            scene::Materials::Whole(m) => fem_tet10::Materials::Uniform(material(m)),
            scene::Materials::ByGroup(groups) => {
                fem_tet10::Materials::ByGroup(groups.iter().map(|(name, m)| (name.clone(), material(m))).collect())
            }
        }
    }

    fn fem_point_masses(&self) -> Vec<fem_tet10::PointMass> {
        let point_mass = |p: &scene::PointMass| fem_tet10::PointMass { at: p.at, mass: p.mass, spread: p.spread };
        self.point_masses.iter().map(point_mass).collect()
    }
}

impl Scene {
    /// Mass properties with each element's mass at its centroid, as the paper prints them.
    ///
    /// # Errors
    /// As [`Model::build`], for materials and point masses.
    pub fn centroid_lumped_inertia(&self, mesh: &Mesh) -> Result<fem_tet10::LumpedInertia, BuildError> {
        let body = meshed(self)?;
        Ok(fem_tet10::centroid_lumped_inertia(mesh, &body.fem_materials(), &body.fem_point_masses())?)
    }
}

fn timed<T>(time: &mut Duration, work: impl FnOnce() -> T) -> T {
    let started = Instant::now();
    let result = work();
    *time = started.elapsed();
    result
}

/// The body with a mesh.
fn meshed(scene: &Scene) -> Result<&MeshedBody, SceneError> {
    match &scene.body {
        Body::Meshed(body) => Ok(body),
        Body::Rigid(_) => {
            let cure = "give a mesh and a material, or use a later version";
            Err(scene.refuse("body.rigid", "a body without a mesh", "a mesh in this version", cure))
        }
    }
}

/// Damping ratio of each flexible mode.
fn damping_ratios(scene: &Scene, modes: &Modes) -> Vec<f64> {
    let ratio = |(mode, eigenvalue): (usize, &f64)| scene.modes.damping.ratio(mode, eigenvalue.sqrt());
    modes.eigenvalues.iter().enumerate().map(ratio).collect()
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
    assemble(mesh, &body.fem_materials(), &body.fem_point_masses()).map_err(|error| {
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
        AssemblyError::MissingGroup { group, present, .. } => scene.refuse(
            key,
            format!("the physical volume \"{group}\", which the mesh has not"),
            format!("one of {present:?}"),
            "rename it, or name the volume in the geometry and mesh again",
        ),
        _ => scene.refuse(key, message, "something that fits the mesh", "correct it"),
    }
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
