//! What all models of a body share, whatever effects and modes they have: its mesh and its matrices.

use std::sync::{Arc, OnceLock};
use std::time::Duration;

use fem_tet10::{Matrices, Mesh};
use frames_rk4::Drive;
use mesh_import::Imported;
use modal::Support;

use super::error::BuildError;
use super::mesh::{matrices, read_mesh};
use super::progress::{BuildProgress, BuildTimes, timed};
use super::store::Store;
use super::support::support;
use crate::scene::{Body, MeshedBody, RigidBody, Scene};

/// The mesh and the matrices of the body of a scene, and what holds it.
pub struct Assembly(pub(super) Assembled);

pub(super) enum Assembled {
    Meshed(Box<AssembledMesh>),
    Rigid(RigidBody),
}

pub(super) struct AssembledMesh {
    /// For messages.
    pub scene: Scene,
    pub body: MeshedBody,
    pub mesh: Arc<Mesh>,
    /// What of the mesh file was left out.
    pub mesh_notes: Vec<String>,
    /// Those that are needed: where answers are known, none are.
    matrices: OnceLock<(Matrices, Duration)>,
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
            Body::Rigid(body) => return Ok(Self(Assembled::Rigid(*body))),
        };
        let mut times = BuildTimes::default();
        progress(BuildProgress::Mesh);
        let store = timed(&mut times.mesh, || Store::open(scene, &body))?;
        let read = || match &store {
            Some(store) => store.mesh(scene, &body),
            None => read_mesh(scene, &body),
        };
        let mut of_mesh = Duration::ZERO;
        let Imported { mesh, notes: mesh_notes } = timed(&mut of_mesh, read)?;
        let mesh = Arc::new(mesh);
        times.mesh += of_mesh;
        let (support, drive) = support(scene, Some(&mesh))?;
        let (scene, matrices) = (scene.clone(), OnceLock::new());
        let assembled = AssembledMesh { scene, body, mesh, mesh_notes, matrices, support, drive, store, times };
        if assembled.store.is_none() {
            progress(BuildProgress::Assembly);
            assembled.matrices()?;
        }
        Ok(Self(Assembled::Meshed(Box::new(assembled))))
    }
}

impl AssembledMesh {
    /// Mass and stiffness, assembled at the first call.
    pub fn matrices(&self) -> Result<&Matrices, BuildError> {
        if let Some((found, _)) = self.matrices.get() {
            return Ok(found);
        }
        let mut time = Duration::ZERO;
        let assembled = timed(&mut time, || matrices(&self.scene, &self.body, &self.mesh))?;
        self.scene.cache.has_assembled();
        Ok(&self.matrices.get_or_init(|| (assembled, time)).0)
    }

    /// How long the assembly took.
    pub fn assembly_time(&self) -> Duration {
        self.matrices.get().map_or(Duration::ZERO, |(_, time)| *time)
    }
}
