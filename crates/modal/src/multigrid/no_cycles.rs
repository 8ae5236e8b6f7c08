//! Reasons that cycles do not take the place of the factor.

use std::sync::Arc;

use crate::error::ModalError;

/// The reason that a factor of K + sM which takes long was made all the same: multigrid cycles cannot take its place.
#[derive(Debug, Clone, thiserror::Error)]
#[non_exhaustive]
pub enum NoCycles {
    /// Matrices of which the corners of the elements are not known.
    #[error(
        "they are for second-order elements whose corners are known, not for any matrices; give the body as a mesh of ten-node tetrahedra"
    )]
    NoCorners,
    /// A support.
    #[error("they are for a body that nothing holds, and constraints hold some of its nodes")]
    Held,
    /// Too many modes for the corners.
    #[error("{modes} modes need {needed} corners of elements, and there are {found}; ask for fewer modes")]
    FewCorners {
        /// Modes that are asked for.
        modes: usize,
        /// Corners that these take.
        needed: usize,
        /// Corners that there are.
        found: usize,
    },
    /// Elements without nodes on their edges.
    #[error("{corners} of {nodes} nodes are corners of elements, too many for a coarse problem on the corners")]
    ManyCorners {
        /// Corners.
        corners: usize,
        /// All nodes.
        nodes: usize,
    },
    /// A node without stiffness of its own.
    #[error("the stiffness of a node by itself has no inverse in single precision")]
    NoInverse,
    /// A cycle that leaves too much.
    #[error(
        "a cycle leaves {left:.2} of the strain energy of an error, and at most {limit} is of use; elements about as long as they are thick leave less"
    )]
    FlatElements {
        /// The part that is left; infinite where there is more than before.
        left: f64,
        /// The most.
        limit: f64,
    },
    /// A search for modes without an end.
    #[error(
        "the search for modes with them had not ended after {steps} steps; materials that differ much, or flat elements, do that"
    )]
    NotConverged {
        /// Steps.
        steps: usize,
    },
    /// An error that stops any other search, too.
    #[error("{0}")]
    Failed(Arc<ModalError>),
}

impl From<ModalError> for NoCycles {
    fn from(error: ModalError) -> Self {
        Self::Failed(Arc::new(error))
    }
}

impl From<memory::OutOfMemory> for NoCycles {
    fn from(error: memory::OutOfMemory) -> Self {
        ModalError::from(error).into()
    }
}
