//! Errors of the full body.

use diagnostic::{Diagnosis, Diagnostic, Kind};
use fem_tet10::{AssemblyError, MeshError};
use modal::ModalError;

/// An error of the full nonlinear body.
#[derive(Debug, thiserror::Error)]
pub enum NonlinearError {
    /// Materials or fields that do not fit the mesh.
    #[error(transparent)]
    Assembly(#[from] AssemblyError),
    /// A surface that the mesh does not have.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A support, a factor or memory.
    #[error(transparent)]
    Modal(#[from] ModalError),
    /// Constraints that leave the tangent singular.
    #[error("the tangent stiffness is singular: the body can move without a force")]
    Singular,
    /// An iteration that came to no end.
    #[error(
        "no equilibrium was found in {steps} factors (the last change was {left:.1e} of the displacements): take the load or the spin in steps, or less of it"
    )]
    NoEquilibrium {
        /// Factors that were made.
        steps: usize,
        /// The last change over the displacements.
        left: f64,
    },
    /// A displacement, a force or an acceleration that is not a finite number.
    #[error("{what} that is not a finite number")]
    NotFinite {
        /// Its name.
        what: &'static str,
    },
}

impl Diagnostic for NonlinearError {
    fn diagnosis(&self) -> Diagnosis {
        match self {
            Self::Assembly(error) => error.diagnosis(),
            Self::Mesh(error) => error.diagnosis(),
            Self::Modal(error) => error.diagnosis(),
            Self::Singular | Self::NoEquilibrium { .. } | Self::NotFinite { .. } => Kind::Run.alone(),
        }
    }
}
