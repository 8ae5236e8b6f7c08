//! What all models of a body share, whatever effects and modes they have: its mesh and its matrices.

use std::sync::Arc;

use fem_tet10::{Matrices, Mesh};
use frames_rk4::Drive;
use modal::Support;

use super::error::BuildError;
use super::mesh::{matrices, read_mesh};
use super::progress::{BuildProgress, BuildTimes, timed};
use super::support::support;
use crate::scene::{Body, MeshedBody, RigidBody, Scene};

/// The mesh and the matrices of the body of a scene, and what holds it.
pub struct Assembly(pub(super) Assembled);

pub(super) enum Assembled {
    Meshed(Box<AssembledMesh>),
    Rigid(RigidBody),
}

pub(super) struct AssembledMesh {
    pub body: MeshedBody,
    pub mesh: Arc<Mesh>,
    pub matrices: Matrices,
    pub support: Support,
    pub drive: Option<Drive>,
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
        let mesh = Arc::new(timed(&mut times.mesh, || read_mesh(scene, &body))?);
        progress(BuildProgress::Assembly);
        let matrices = timed(&mut times.assembly, || matrices(scene, &body, &mesh))?;
        let (support, drive) = support(scene, Some(&mesh))?;
        Ok(Self(Assembled::Meshed(Box::new(AssembledMesh { body, mesh, matrices, support, drive, times }))))
    }
}
