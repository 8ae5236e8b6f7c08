//! The full nonlinear body of a scene, beside its reduced model.
//!
//! It has what the model was reduced from: all elements with their nonlinear strain, all loads on their displaced places, whatever
//! effects and modes the model has.

pub(crate) mod acting;
pub(crate) mod check;
pub(crate) mod mends;
pub(crate) mod motion;
pub(crate) mod stress;
pub(crate) mod ties;

use std::borrow::Cow;
use std::sync::Arc;

use diagnostic::{Diagnosis, Diagnostic};
use nonlinear::{FullBody, NonlinearError};
use scene::Body;

use crate::building::assembly::{Assembled, AssembledMesh};
use crate::building::builder::Builder;
use crate::building::progress::BuildProgress;
use crate::error::BuildError;
use crate::load::mesh_load::{self, MeshLoad, UnitWeight};
use crate::mesh::fe_matrices::FeMatrices;
use crate::tie::mesh_marker::{self, MeshMarker};

/// The full nonlinear body of a scene.
pub struct FullModel {
    assembled: Box<AssembledMesh>,
    loads: Vec<MeshLoad>,
    markers: Vec<MeshMarker>,
}

/// A scene without a full body, or a full body that cannot be solved.
#[derive(Debug, thiserror::Error)]
pub enum FullError {
    /// The mesh, the matrices or the loads.
    #[error("{0}")]
    Build(#[from] BuildError),
    /// Elements, factors, memory.
    #[error("{0}")]
    Nonlinear(#[from] NonlinearError),
    /// The motion of the model at a state.
    #[error("{0}")]
    Motion(#[from] dynamics::LoadedError),
    /// Elements whose stress cannot be found.
    #[error("{0}")]
    Assembly(#[from] fem_tet10::AssemblyError),
    /// A point of the output that is not on the mesh.
    #[error("{0}")]
    Setup(#[from] dynamics::SetupError),
}

impl Builder {
    /// The full body of a scene; `None` of a body without elements: a rigid one, or one of matrices.
    ///
    /// # Errors
    /// As [`Builder::build`].
    pub fn full(&self, body: &Body, progress: impl FnMut(BuildProgress)) -> Result<Option<FullModel>, BuildError> {
        let builder = Builder { cache: self.cache.with_own_notes(), ..self.clone() };
        let Assembled::Meshed(assembled) = builder.assemble(body, progress)?.0 else { return Ok(None) };
        if assembled.elements().is_none() {
            return Ok(None);
        }
        let FeMatrices::Assembled(matrices) = assembled.matrices()? else { return Ok(None) };
        let weight = Arc::new(UnitWeight::of_elements(matrices).map_err(crate::error::modal(body))?);
        let loads = mesh_load::on_mesh(&assembled.needed(), &assembled.mesh, 3, &weight)?;
        let markers = mesh_marker::on_mesh(body, &assembled.mesh, 3)?;
        Ok(Some(FullModel { assembled, loads, markers }))
    }
}

impl FullModel {
    /// The full body.
    ///
    /// # Errors
    /// Materials or a support that do not fit the mesh.
    pub fn body(&self) -> Result<FullBody<'_>, FullError> {
        let AssembledMesh { mesh, support, .. } = &*self.assembled;
        let FeMatrices::Assembled(matrices) = self.assembled.matrices()? else {
            // A full model is made of elements.
            return Err(NonlinearError::Singular.into());
        };
        let materials = self.assembled.materials()?;
        Ok(FullBody::new(Arc::clone(mesh), materials, Cow::Borrowed(matrices), support)?)
    }
}

impl Diagnostic for FullError {
    fn diagnosis(&self) -> Diagnosis {
        match self {
            Self::Build(error) => error.diagnosis(),
            Self::Nonlinear(error) => error.diagnosis(),
            Self::Motion(error) => error.diagnosis(),
            Self::Assembly(error) => error.diagnosis(),
            Self::Setup(error) => error.diagnosis(),
        }
    }
}
