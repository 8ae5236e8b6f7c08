//! The base that all models of a body share, whatever effects and modes they have: its mesh and its matrices.

use std::sync::{Arc, OnceLock};
use std::time::Duration;

use dynamics::{Drive, Effect};
use fem_tet10::{Materials, Mesh};
use matrix_import::MatrixFiles;
use mesh_import::Imported;
use modal::Support;

use super::doubt::doubts;
use super::error::BuildError;
use super::fe_matrices::FeMatrices;
use super::given::{Given, MatrixChecks};
use super::mesh::{matrices, mesh_file, mesh_in};
use super::other_materials::other_materials;
use super::progress::{BuildProgress, BuildTimes, timed};
use super::store::Store;
use super::support::support;
use crate::constraint::Constraint;
use crate::scene::{Body, MeshedBody, RigidBody, Scene};

/// The mesh and the matrices of the body of a scene, and what holds it.
pub struct Assembly(pub(super) Assembled);

pub(super) enum Assembled {
    Meshed(Box<AssembledMesh>),
    Rigid(RigidBody),
}

/// Source of the matrices of a body.
pub(super) enum MadeOf {
    Elements(MeshedBody),
    Files(MatrixFiles),
}

pub(super) struct AssembledMesh {
    /// For messages.
    pub scene: Scene,
    pub body: MadeOf,
    pub mesh: Arc<Mesh>,
    /// Notes about the parts of the mesh file that were left out.
    pub mesh_notes: Vec<String>,
    /// The matrices, where they are needed: where answers are known, none are.
    matrices: OnceLock<(FeMatrices, Duration)>,
    /// Checks of matrices from another program.
    pub checks: Option<MatrixChecks>,
    pub support: Support,
    pub drive: Option<Drive>,
    /// Where answers are kept from run to run.
    pub store: Option<Store>,
    pub times: BuildTimes,
}

impl Assembly {
    /// Reads the mesh of a scene, and assembles its matrices.
    ///
    /// # Errors
    /// [`BuildError`]: what the mesh, the materials or the supports refuse.
    pub fn new(scene: &Scene, mut progress: impl FnMut(BuildProgress)) -> Result<Self, BuildError> {
        let body = match &scene.body {
            Body::Meshed(body) => body.clone(),
            Body::Matrices(files) => return Self::of_matrices(scene, files, progress),
            Body::Rigid(body) => return Ok(Self(Assembled::Rigid(*body))),
        };
        let mut times = BuildTimes::default();
        progress(BuildProgress::Mesh);
        let read = || {
            // It is read once: the answers that are kept and the mesh are of the same bytes.
            let file = if body.file.is_none() { Some(mesh_file(scene, &body)?) } else { None };
            let store = Store::open(scene, &body, file.as_ref())?;
            let made = || match &file {
                Some(file) => mesh_in(scene, file),
                None => mesh_in(scene, &mesh_file(scene, &body)?),
            };
            let imported = match &store {
                Some(store) => store.mesh(scene, &body, made)?,
                None => made()?,
            };
            Ok::<_, BuildError>((store, imported))
        };
        let (store, Imported { mesh, notes: mut mesh_notes, materials }) = timed(&mut times.mesh, read)?;
        mesh_notes.extend(other_materials(&mesh, &materials, &body.materials));
        let mesh = Arc::new(mesh);
        doubts(scene, &mesh).into_iter().for_each(|doubt| progress(BuildProgress::Doubt(doubt)));
        let (support, drive) = support(scene, Some((&mesh, 3)))?;
        let (scene, matrices, body) = (scene.clone(), OnceLock::new(), MadeOf::Elements(body));
        let checks = None;
        let assembled = AssembledMesh { scene, body, mesh, mesh_notes, matrices, checks, support, drive, store, times };
        if assembled.store.is_none() {
            progress(BuildProgress::Assembly);
            assembled.matrices()?;
        }
        Ok(Self(Assembled::Meshed(Box::new(assembled))))
    }

    /// All that the assembly of a scene is made of, as a text: scenes with the same may share it.
    pub fn made_of(scene: &Scene) -> String {
        let flexibility = scene.effects.choices[Effect::Flexibility];
        // Such a support is checked against what the scene begins with.
        let initial = matches!(scene.constraint, Some(Constraint::Support { .. })).then_some(&scene.initial);
        format!("{:?} {:?} {:?} {flexibility:?} {initial:?}", scene.body, scene.constraint, scene.modes.flexible)
    }

    /// The same without the matrices, which are assembled again where they are needed, for who keeps it for long.
    pub fn without_matrices(mut self) -> Self {
        if let Assembled::Meshed(assembled) = &mut self.0
            && let MadeOf::Elements(_) = assembled.body
        {
            assembled.matrices.take();
        }
        self
    }

    /// The same of matrices from another program, which are read each time.
    fn of_matrices(
        scene: &Scene,
        files: &MatrixFiles,
        mut progress: impl FnMut(BuildProgress),
    ) -> Result<Self, BuildError> {
        let mut times = BuildTimes::default();
        progress(BuildProgress::Mesh);
        let given = timed(&mut times.mesh, || Given::read(scene, files))?;
        let Given { nodes, hash, notes: mesh_notes, matrices, checks } = given;
        let mesh = Arc::new(nodes);
        let store = Store::of_matrices(scene, hash);
        let (support, drive) = support(scene, Some((&mesh, checks.dofs)))?;
        let (scene, body, checks) = (scene.clone(), MadeOf::Files(files.clone()), Some(checks));
        let matrices = OnceLock::from((matrices, Duration::ZERO));
        let assembled = AssembledMesh { scene, body, mesh, mesh_notes, matrices, checks, support, drive, store, times };
        Ok(Self(Assembled::Meshed(Box::new(assembled))))
    }
}

impl AssembledMesh {
    /// Mass and stiffness, assembled at the first call.
    pub fn matrices(&self) -> Result<&FeMatrices, BuildError> {
        if let Some((found, _)) = self.matrices.get() {
            return Ok(found);
        }
        let mut time = Duration::ZERO;
        let MadeOf::Elements(body) = &self.body else { return Err(self.without_elements()) };
        let assembled = timed(&mut time, || matrices(&self.scene, body, &self.mesh))?;
        self.scene.cache.has_assembled();
        Ok(&self.matrices.get_or_init(|| (FeMatrices::Assembled(assembled), time)).0)
    }

    /// Degrees of freedom of a node.
    pub fn dofs(&self) -> usize {
        self.checks.map_or(3, |checks| checks.dofs)
    }

    /// Materials of the elements.
    pub fn materials(&self) -> Result<&Materials, BuildError> {
        match &self.body {
            MadeOf::Elements(body) => Ok(&body.materials),
            MadeOf::Files(_) => Err(self.without_elements()),
        }
    }

    /// The refusal of what needs elements.
    fn without_elements(&self) -> BuildError {
        let found = "a body of matrices, whose elements are not known";
        self.scene.refuse("body.matrices", found, "a body with elements", "give the body a mesh and a material").into()
    }

    /// How long the assembly took.
    pub fn assembly_time(&self) -> Duration {
        self.matrices.get().map_or(Duration::ZERO, |(_, time)| *time)
    }
}
