//! The stress of loads that stay as they are.

use advice::{Row, steady_stress};
use faer::{Mat, MatRef};
use fem_tet10::{AssemblyError, geometric_stiffness_product};
use frames_rk4::Effect;
use modal::{ModalError, Modes};

use super::error::{BuildError, modal};
use super::mesh_model::MeshModel;
use super::modal_model::ModalModel;
use crate::effects::Choice;

/// What the stress of steady loads does to a body.
#[derive(Default)]
pub(super) struct SteadyStress {
    /// Stiffness in the modes (nf × nf), none where it may be left out.
    pub stiffness: Option<Mat<f64>>,
    /// What the advice says of it.
    pub row: Option<Row>,
    /// The loads over those at which the body buckles; 0 where they do not make it buckle.
    pub buckling_ratio: f64,
}

impl SteadyStress {
    /// By the static answer (3n × 1) to the loads.
    pub fn new(
        model: &MeshModel<'_>,
        answer: Option<&Mat<f64>>,
        modes: &Modes,
        body: &ModalModel,
    ) -> Result<Self, BuildError> {
        // Gravity stresses no body that falls.
        let Some(answer) = answer.filter(|answer| modes.shapes.ncols() > 0 && answer.norm_max() > 0.0) else {
            return Ok(Self::default());
        };
        let effects = &model.scene.effects;
        let buckling_ratio = buckling_ratio(model, answer.as_ref(), modes)?;
        let Some(stiffness) = model.stress_stiffness(answer.as_ref(), modes)?.pop() else {
            return Ok(Self { buckling_ratio, ..Self::default() });
        };
        let row = steady_stress(&body.case(model), stiffness.as_ref(), effects.tolerance)?;
        let acts = effects.choices[Effect::GeometricStiffening] == Choice::On || row.on;
        Ok(Self { stiffness: acts.then_some(stiffness), row: Some(row), buckling_ratio })
    }
}

/// The loads of a static `answer` over those at which the body buckles, on the whole mesh: the modes that are kept do not
/// hold the shape in which it does.
fn buckling_ratio(model: &MeshModel<'_>, answer: MatRef<'_, f64>, modes: &Modes) -> Result<f64, BuildError> {
    let product = |fields: MatRef<'_, f64>| -> Result<Mat<f64>, BucklingError> {
        Ok(geometric_stiffness_product(model.mesh, &model.body.materials, answer, fields)?)
    };
    match model.solver.lowest_buckling_ratio(modes.shapes.as_ref(), product) {
        Ok(lowest) => Ok(-lowest),
        Err(BucklingError::Modal(error)) => Err(modal(model.scene)(error)),
        Err(BucklingError::Assembly(error)) => Err(error.into()),
    }
}

/// What the search for the buckling load may meet.
#[derive(Debug, thiserror::Error)]
enum BucklingError {
    #[error(transparent)]
    Modal(#[from] ModalError),
    #[error(transparent)]
    Assembly(#[from] AssemblyError),
}
