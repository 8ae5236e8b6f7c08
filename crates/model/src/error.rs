//! Errors of a scene that cannot be built or started, each at its place in the scene file.

use std::path::{Path, PathBuf};

use advice::{AdviceError, Refusal};
use diagnostic::{Diagnosis, Diagnostic, Kind};
use dynamics::{LoadedError, SetupError};
use fem_tet10::{AssemblyError, AssemblyFault, MeshError, MeshFault};
use mesh_import::ImportError;
use modal::ModalError;
use nalgebra::Vector3;
use scene::{Body, Place, SceneError, one_of, shorten};
use sealed::SealedError;

/// A scene that cannot be built.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum BuildError {
    /// Something in the scene does not fit the mesh.
    #[error("{0}")]
    Scene(#[from] SceneError),
    /// The mesh cannot be used.
    #[error("{0}")]
    Mesh(#[from] MeshError),
    /// The mesh cannot be imported.
    #[error("{0}")]
    Import(#[from] Box<ImportError>),
    /// The matrices cannot be assembled.
    #[error("{0}")]
    Assembly(#[from] AssemblyError),
    /// The modes cannot be found.
    #[error("{}: {source}", scene.display())]
    Modal { scene: PathBuf, source: ModalError },
    /// A body file cannot be read or written.
    #[error("{0}")]
    BodyFile(#[from] SealedError),
    /// No advice can be given on it.
    #[error("{0}")]
    Advice(#[from] AdviceError),
    /// A body in joints that is known to be wrong.
    #[error("{}: {source}", scene.display())]
    Refused { scene: PathBuf, source: Refusal },
    /// A load or a joint that the integrator refuses.
    #[error("{0}")]
    Load(#[from] SetupError),
    /// The vibrations under steady loads are not known.
    #[error("{}: {source}", scene.display())]
    Loaded { scene: PathBuf, source: Box<LoadedError> },
}

/// A motion that cannot start.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum StartError {
    /// The integrator refuses it.
    #[error("{0}")]
    Setup(#[from] SetupError),
    /// The step that the scene names is beyond the limit of the method.
    #[error("{}", at.show(&format!("found {found}, expected {expected}"), help))]
    Step { at: Box<Place>, found: String, expected: String, help: &'static str },
    /// The model is known to be wrong.
    #[error("{0}")]
    Refused(#[from] Refusal),
    /// A point mass of a system that something would turn. `by`: what would.
    #[error(
        "{}",
        at.show(&format!("found a point mass, without moments of inertia, that {by} would turn, expected an inertia"), POINT_HELP)
    )]
    Point { at: Box<Place>, by: Box<str> },
    /// Joints hold the body.
    #[error("{}", at.show("found a body that joints, springs or bushings hold, expected one that moves alone", TIED_HELP))]
    Tied { at: Box<Place> },
}

const POINT_HELP: &str = "give it an inertia, or let what acts on it act at its own point and hold none of its turns (a spherical joint, a \
                          spring, an equation between points)";
const TIED_HELP: &str = "run the whole scene, or take what ties the body out of it";

impl StartError {
    /// Refuses a body that joints, springs or bushings hold, for who moves it alone.
    ///
    /// # Errors
    /// [`StartError::Tied`].
    pub fn refuse_tied(body: &Body) -> Result<(), Self> {
        if body.tied { Err(Self::Tied { at: body.place("body").into() }) } else { Ok(()) }
    }

    /// The message, which begins with the scene file.
    pub fn in_scene(&self, path: &Path) -> String {
        match self {
            Self::Step { .. } | Self::Tied { .. } | Self::Point { .. } => self.to_string(),
            Self::Setup(_) | Self::Refused(_) => format!("{}: {self}", path.display()),
        }
    }

    /// Number in its system of the body that is refused, if it is one.
    pub fn body_of_system(&self) -> Option<usize> {
        match self {
            Self::Setup(SetupError::PointTurned { body, .. } | SetupError::StepBeyondBody { body, .. }) => {
                Some(body.number)
            }
            _ => None,
        }
    }

    /// At the key of the scene, where it is the step or an inertia.
    #[must_use]
    pub fn at_key(self, given: &Body) -> Self {
        if let Self::Setup(SetupError::PointTurned { by, .. }) = self {
            return Self::Point { at: given.place("body.rigid.inertia").into(), by };
        }
        let (step, limit, why, help) = match &self {
            Self::Setup(SetupError::StepBeyondLimit { step, limit, mode, frequency }) => (
                step,
                limit,
                format!("the stability limit that flexible mode {mode} ({frequency:.6} cycles per time) sets for RK4"),
                "take a smaller step or fewer modes",
            ),
            Self::Setup(SetupError::StepBeyondBody { step, limit, body, frequency }) => (
                step,
                limit,
                format!(
                    "the stability limit that the fastest shape of {body} ({frequency:.6} cycles per time) sets for `rkmk4`"
                ),
                "take a smaller step, or `scheme = \"radau\"`, which has no such limit",
            ),
            Self::Setup(SetupError::StepBeyondSpin { step, limit, spin }) => (
                step,
                limit,
                format!("what this scheme follows of a spin of {spin:.6} rad per time"),
                "take a smaller step",
            ),
            _ => return self,
        };
        let (found, expected) = (format!("a step of {step:e}, beyond {why}"), format!("at most {limit:.4e}"));
        Self::Step { at: given.place("time.step").into(), found, expected, help }
    }
}

/// An assembly error at its place in the scene file.
pub(crate) fn refuse(body: &Body, key: &str, error: AssemblyError) -> SceneError {
    let message = error.to_string();
    let mesh = error.mesh.unwrap_or_default();
    match error.fault {
        AssemblyFault::OffBody { node, position, distance, .. } => {
            // A coordinate that is zero but for rounding is shown as zero.
            let size = Vector3::from(position).norm();
            let shown = position.map(|c| if c.abs() < 1e-9 * size { 0.0 } else { c });
            if !body.source.has_elements() {
                return body.refuse(
                    key,
                    format!("a point without a node: the nearest one of {mesh} is {distance:.6} away"),
                    "a node: the elements between the nodes of a body of matrices are not known",
                    format!("use its node {node} at {shown:?}"),
                );
            }
            body.refuse(
                key,
                format!("a point that is not on the body: the nearest node of {mesh} is {distance:.6} away"),
                "a point of the body",
                format!("use a point of the body; its node {node} is at {shown:?}"),
            )
        }
        AssemblyFault::Spread { radius, count, distance, .. } => body.refuse(
            key,
            format!("{count} node(s) within {radius}, the nearest {distance:.6} away"),
            "nodes all around the point that can carry the mass",
            "use a larger spread, or leave it out for a point of the body",
        ),
        AssemblyFault::Patch { radius, count, distance, .. } => body.refuse(
            key,
            format!("{count} node(s) within {radius}, the nearest {distance:.6} away"),
            "three nodes or more, not on a line, that can take the moment",
            "use a larger radius, or leave it out for a point of the body",
        ),
        AssemblyFault::MissingGroup { group, present, .. } => body.refuse(
            key,
            format!("the physical volume \"{}\", which the mesh has not", shorten(&group)),
            one_of(&present),
            "rename it, or name the volume in the geometry and mesh again",
        ),
        _ => body.refuse(key, message, "something that fits the mesh", "correct it"),
    }
}

/// A mesh error, such as a group that is not there, at its place in the scene file.
pub(crate) fn refuse_mesh(body: &Body, key: &str, error: &MeshError) -> BuildError {
    if let MeshFault::NoGroup { kind, group, present } = &error.fault {
        let (what, help) = if body.source.has_elements() {
            ("mesh", "use one of these, or name it in the geometry and mesh again")
        } else {
            ("body", "use one of these, or add it to the groups in the table of nodes (*NSET in an .inp file)")
        };
        let found = format!("the physical {kind} \"{}\", which the {what} has not", shorten(group));
        return body.refuse(key, found, one_of(present), help).into();
    }
    body.refuse(key, error.to_string(), "something that the mesh has", "name it in the geometry, and mesh again").into()
}

pub(crate) fn too_many_modes(body: &Body, error: ModalError) -> BuildError {
    match error {
        ModalError::TooManyModes { available: 0, .. } => body
            .refuse(
                "constraints[0]",
                "a support that holds every node of the body",
                "a part of the body that is free to deform",
                "hold fewer nodes, or set `flexible = 0` in [modes]",
            )
            .into(),
        ModalError::TooManyModes { requested, available } => body
            .refuse(
                "modes.flexible",
                requested.to_string(),
                format!("at most {available}: a mode for each degree of freedom that has mass and that nothing holds, less the rigid ones"),
                "ask for fewer modes, or use a finer mesh",
            )
            .into(),
        other => modal(body)(other),
    }
}

/// Adds the scene file to errors of the modal analysis, which know no file.
pub(crate) fn modal<E: Into<ModalError>>(body: &Body) -> impl Fn(E) -> BuildError {
    |source| BuildError::Modal { scene: body.path.clone(), source: source.into() }
}

impl Diagnostic for BuildError {
    fn diagnosis(&self) -> Diagnosis {
        match self {
            Self::Scene(error) => error.diagnosis(),
            Self::Mesh(error) => error.diagnosis(),
            Self::Import(error) => error.diagnosis(),
            Self::Assembly(error) => error.diagnosis(),
            Self::Modal { scene, source } => source.diagnosis().in_file(scene),
            Self::BodyFile(error) => error.diagnosis(),
            Self::Advice(error) => error.diagnosis(),
            Self::Refused { scene, .. } => Kind::Refused.of(scene),
            Self::Load(error) => error.diagnosis(),
            Self::Loaded { scene, source } => source.diagnosis().in_file(scene),
        }
    }
}

impl Diagnostic for StartError {
    fn diagnosis(&self) -> Diagnosis {
        match self {
            Self::Setup(error) => error.diagnosis(),
            Self::Refused(_) => Kind::Refused.alone(),
            Self::Step { at, found, expected, help } => {
                let refused = Kind::Refused.of(&at.file).line(at.line).key(&at.key);
                refused.found(found).expected(expected).help(*help)
            }
            Self::Tied { at } | Self::Point { at, .. } => Kind::Refused.of(&at.file).line(at.line).key(&at.key),
        }
    }
}
