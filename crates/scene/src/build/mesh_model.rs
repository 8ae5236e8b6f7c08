//! The finite-element model of a scene.

use faer::{Mat, MatRef};
use fem_tet10::{GeometricTerms, Matrices, Mesh, reduced_geometric_stiffness};
use frames_rk4::Drive;
use modal::{Modes, Solver, Support};

use super::error::BuildError;
use super::loads::MeshLoad;
use crate::scene::{MeshedBody, Scene};

/// The finite-element model of a scene: what modes, static answers and the reduced body are made from.
pub(super) struct MeshModel<'a> {
    pub scene: &'a Scene,
    pub body: &'a MeshedBody,
    pub mesh: &'a Mesh,
    pub matrices: &'a Matrices,
    pub solver: &'a Solver<'a>,
    pub support: &'a Support,
    /// Those that may act.
    pub loads: Vec<MeshLoad>,
    pub drive: Option<Drive>,
}

impl MeshModel<'_> {
    /// Stiffness in the modes (nf × nf) by the stress of each static answer (3n × m).
    pub fn stress_stiffness(
        &self,
        answers: MatRef<'_, f64>,
        modes: &Modes,
        terms: GeometricTerms,
    ) -> Result<Vec<Mat<f64>>, BuildError> {
        Ok(reduced_geometric_stiffness(self.mesh, &self.body.materials, answers, modes.shapes.as_ref(), terms)?)
    }
}
