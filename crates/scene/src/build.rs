//! From a scene to a body that can move.

mod backbones;
mod decide;
mod history;
mod loads;
mod mesh_model;
mod meshed;
mod modal_model;
mod physics;
mod reduce;
mod rigid;
mod statics;
mod steady_stress;
mod support;
mod survey;

use std::path::PathBuf;
use std::time::{Duration, Instant};

use advice::{Advice, AdviceError, Backbone, Case, Refusal, StepEstimate};
use fem_tet10::{AssemblyError, Matrices, Mesh, MeshError, assemble, read_msh};
use frames_rk4::{Initial, Physics, PointShapes, Rows, Setup, SetupError, SharedLoad, Simulation, StepControl};
use modal::{ModalError, Modes, ReducedBody};
use nalgebra::Vector3;
use rigid_kin::Attitude;

use crate::effects::Choice;
use crate::error::{SceneError, shorten};
use crate::scene::{Body, MeshedBody, Scene};
use crate::suggest::one_of;

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
    #[error("{}: {source}", scene.display())]
    Modal {
        /// The scene file.
        scene: PathBuf,
        /// Why.
        source: ModalError,
    },
    /// No advice can be given on it.
    #[error(transparent)]
    Advice(#[from] AdviceError),
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
    /// Which effects the scene calls for, and why.
    pub advice: Advice,
    /// Why the model is known to be wrong, if it is: it does not start unless the scene says `refuse = false`.
    pub refusal: Option<Refusal>,
    /// Where the time went.
    pub times: BuildTimes,
    loads: Vec<SharedLoad>,
    damping_ratios: Vec<f64>,
    size: Size,
    /// What the modes leave out of the static answers to the spin (6), where that is to be watched.
    left_out: Vec<f64>,
    /// Of the modes that may bend the body far.
    backbones: Vec<Option<Backbone>>,
}

/// The size of a body and of its modes.
#[derive(Debug, Clone)]
struct Size {
    /// Largest distance of two points of the body.
    length: f64,
    /// Largest displacement of a node in each mode (nf).
    peaks: Vec<f64>,
}

impl Model {
    /// Reads the mesh of a scene, finds its modes and reduces the body. `progress` hears what is being done.
    ///
    /// # Errors
    /// [`BuildError`]: what the mesh, the materials or the modes refuse, with the place in the scene file where
    /// there is one.
    pub fn build(scene: &Scene, progress: impl FnMut(BuildProgress)) -> Result<Self, BuildError> {
        match &scene.body {
            Body::Meshed(body) => meshed::build(scene, body, progress),
            Body::Rigid(body) => rigid::build(scene, body),
        }
    }

    /// Frequencies of the flexible modes, cycles per time.
    pub fn natural_frequencies(&self) -> Vec<f64> {
        self.body.circular_frequencies.iter().map(|omega| omega / std::f64::consts::TAU).collect()
    }

    /// The same body with its first `flexible` modes only.
    pub fn truncated(&self, flexible: usize) -> Self {
        let flexible = flexible.min(self.body.flexible());
        let meshed = self.meshed.as_ref().map(|meshed| Meshed {
            mesh: meshed.mesh.clone(),
            modes: truncated_modes(&meshed.modes, flexible),
            ..*meshed
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
            loads: self.loads.clone(),
            damping_ratios: self.damping_ratios[..flexible].to_vec(),
            size: Size { peaks: self.size.peaks[..flexible].to_vec(), ..self.size },
            advice: self.advice.clone(),
            left_out: self.left_out.clone(),
            backbones: self.backbones.iter().copied().take(flexible).collect(),
            ..*self
        }
    }

    /// Damping ratio of each flexible mode.
    pub fn damping_ratios(&self) -> &[f64] {
        &self.damping_ratios
    }

    /// The loads, at their points of the body.
    pub fn loads(&self) -> &[SharedLoad] {
        &self.loads
    }

    /// How many static shapes follow the natural modes.
    pub fn static_shapes(&self) -> usize {
        self.meshed.as_ref().map_or(0, |meshed| meshed.modes.eigenvalues.len() - meshed.modes.natural())
    }

    /// How the frequency of each of the first modes goes with its amplitude, of those that may bend the body far.
    pub fn backbones(&self) -> &[Option<Backbone>] {
        &self.backbones
    }

    /// Largest displacement by deformation over the length of the body, bounded above by the sum over the modes.
    pub fn deflection(&self, modal_displacement: &[f64]) -> f64 {
        modal_displacement.iter().zip(&self.size.peaks).map(|(q, peak)| (q * peak).abs()).sum::<f64>()
            / self.size.length
    }

    /// The state that a scene begins with, its lists padded with zeros.
    pub fn initial(&self, scene: &Scene) -> Initial {
        initial(scene, self.body.flexible())
    }

    /// The run as [`advice`] sees it, which begins with `initial`.
    pub fn case<'a>(&'a self, scene: &Scene, initial: &'a Initial) -> Case<'a> {
        Case {
            body: &self.body,
            damping_ratios: &self.damping_ratios,
            loads: &self.loads,
            is_gravity: &[],
            drive: self.physics.drive.as_ref(),
            initial,
            end: scene.time.end,
            length: self.size.length,
            peaks: &self.size.peaks,
            static_compliances: &[],
            centrifugal_remainders: &self.left_out,
            backbones: &self.backbones,
        }
    }

    /// The motion of a scene from its beginning.
    ///
    /// # Errors
    /// [`StartError`], e.g. a step beyond the stability limit.
    pub fn start(&self, scene: &Scene) -> Result<Simulation, StartError> {
        self.start_with(scene, scene.time.method, scene.time.control, scene.output.rows)
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
    ) -> Result<Simulation, StartError> {
        if let Some(refusal) = self.refusal.filter(|_| scene.effects.refuse) {
            return Err(refusal.into());
        }
        let points: Vec<PointShapes> = self.points.iter().map(|(_, point)| point.clone()).collect();
        let initial = self.initial(scene);
        let setup = Setup { method, control, rows, points: &points, ..self.setup(scene, &initial) };
        Ok(Simulation::new(&setup)?)
    }

    /// What the length of the steps gets wrong, estimated; nothing under step control.
    ///
    /// # Errors
    /// As [`Model::start`].
    pub fn step_estimate(&self, scene: &Scene) -> Result<Option<StepEstimate>, StartError> {
        Ok(advice::step_estimate(&self.setup(scene, &self.initial(scene)))?)
    }

    /// What [`Simulation::new`] needs for the run of a scene, without its points. Loads, steps or anything else may be
    /// replaced.
    pub fn setup<'a>(&'a self, scene: &Scene, initial: &'a Initial) -> Setup<'a> {
        Setup {
            body: &self.body,
            damping_ratios: &self.damping_ratios,
            loads: &self.loads,
            physics: &self.physics,
            reference_points: self.reference_points,
            initial,
            method: scene.time.method,
            control: scene.time.control,
            end: scene.time.end,
            rows: scene.output.rows,
            points: &[],
        }
    }
}

/// A motion that cannot start.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StartError {
    /// The integrator refuses it.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// The model is known to be wrong.
    #[error(transparent)]
    Refused(#[from] Refusal),
}

/// The attitude at the beginning. The scene has been checked: no quaternion in it names no rotation.
fn first_attitude(scene: &Scene) -> Attitude {
    scene.initial.attitude.and_then(|wxyz| Attitude::from_wxyz(wxyz).ok()).unwrap_or(Attitude::identity())
}

fn initial(scene: &Scene, flexible: usize) -> Initial {
    let padded = |list: &[f64]| (0..flexible).map(|k| list.get(k).copied().unwrap_or(0.0)).collect();
    Initial {
        attitude: first_attitude(scene),
        velocity: scene.initial.velocity.into(),
        omega: scene.initial.angular_velocity.into(),
        modal_displacement: padded(&scene.initial.modal_displacement),
        modal_velocity: padded(&scene.initial.modal_velocity),
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
                Ok(Some(fem_tet10::centroid_lumped_inertia(mesh, &body.materials, &body.point_masses)?))
            }
            Body::Rigid(_) => Ok(None),
        }
    }
}

fn output_points(
    scene: &Scene,
    point: impl Fn(String, [f64; 3]) -> Result<PointShapes, BuildError>,
) -> Result<Vec<(String, PointShapes)>, BuildError> {
    let named = scene.output.points.iter();
    named.map(|(name, at)| Ok((name.clone(), point(format!("output.points.{name}"), *at)?))).collect()
}

/// The first of some modes.
fn truncated_modes(modes: &Modes, flexible: usize) -> Modes {
    let mut modes = modes.clone();
    modes.eigenvalues.truncate(flexible);
    modes.residuals.truncate(flexible);
    modes.force_residuals.truncate(flexible);
    modes.shapes = modes.shapes.get(.., ..flexible).to_owned();
    modes
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
                format!("a mesh that cannot be read: {}: {source}", shorten(&source_name)),
                "a MSH 4.1 file, its path relative to the folder of the scene file",
                "correct the path, or make the mesh: gmsh -3 -order 2 -format msh41 BODY.geo",
            )
            .into(),
        other => other.into(),
    })
}

fn matrices(scene: &Scene, body: &MeshedBody, mesh: &Mesh) -> Result<Matrices, BuildError> {
    assemble(mesh, &body.materials, &body.point_masses).map_err(|error| {
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
            format!("the physical volume \"{}\", which the mesh has not", shorten(&group)),
            one_of(&present),
            "rename it, or name the volume in the geometry and mesh again",
        ),
        _ => scene.refuse(key, message, "something that fits the mesh", "correct it"),
    }
}

/// A mesh error, such as a group that is not there, at its place in the scene file.
fn refuse_mesh(scene: &Scene, key: &str, error: &MeshError) -> BuildError {
    if let MeshError::NoGroup { kind, group, present, .. } = error {
        let cure = "use one of these, or name it in the geometry and mesh again";
        let found = format!("the physical {kind} \"{}\", which the mesh has not", shorten(group));
        return scene.refuse(key, found, one_of(present), cure).into();
    }
    scene
        .refuse(key, error.to_string(), "something that the mesh has", "name it in the geometry, and mesh again")
        .into()
}

fn too_many_modes(scene: &Scene, error: ModalError) -> BuildError {
    match error {
        ModalError::TooManyModes { available: 0, .. } => scene
            .refuse(
                "constraints[0]",
                "a support that holds every node of the body",
                "a part of the body that is free to deform",
                "hold fewer nodes, or set `flexible = 0` in [modes]",
            )
            .into(),
        ModalError::TooManyModes { requested, available } => scene
            .refuse(
                "modes.flexible",
                requested.to_string(),
                format!("at most {available}: three modes for each node that nothing holds, less the rigid ones"),
                "ask for fewer modes, or use a finer mesh",
            )
            .into(),
        other => modal(scene)(other),
    }
}

/// What the modal analysis says knows no file.
fn modal(scene: &Scene) -> impl Fn(ModalError) -> BuildError {
    |source| BuildError::Modal { scene: scene.path.clone(), source }
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
