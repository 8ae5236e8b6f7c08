//! How the frequencies of modes that may bend the body far go with their amplitudes.

use advice::{Advice, Backbone};
use faer::{ColRef, Mat};
use modal::{ModalError, Modes};

use crate::error::BuildError;
use crate::reduction::mesh_model::MeshModel;
use crate::structure::kept::{OwnSecondOrder, SecondOrder};

/// Backbones of the modes that may bend the body far.
pub(crate) struct Backbones {
    /// The backbone of each natural mode that linear strain may get wrong by the bounds of the advice.
    pub of_modes: Vec<Option<Backbone>>,
    /// The static derivatives that they were made of.
    pub derivatives: Derivatives,
}

/// The forces of second order of some natural modes with themselves, and the static responses to them (3n each).
pub(crate) struct Derivatives {
    /// Which modes, numbered from 0.
    modes: Vec<usize>,
    forces: Mat<f64>,
    responses: Mat<f64>,
}

impl Derivatives {
    fn none() -> Self {
        Self { modes: Vec::new(), forces: Mat::new(), responses: Mat::new() }
    }

    /// The force of a mode and the response to it, if they are known.
    pub fn of_mode(&self, mode: usize) -> Option<[ColRef<'_, f64>; 2]> {
        let k = self.modes.iter().position(|known| *known == mode)?;
        Some([self.forces.col(k), self.responses.col(k)])
    }
}

/// The backbones of the natural modes that linear strain may get wrong by the bounds of `advice`; none of others, and none
/// at all where the static responses cannot be found.
///
/// The static modal derivative `Θ = −K⁻¹ g` is made M-orthogonal to its mode φ, so that the modal coordinate stays what
/// it is: with c = φᵀMΘ, its inertia is ΘᵀMΘ − c², its energy −g·Θ − ω²c².
pub(crate) fn backbones(model: &MeshModel<'_, '_>, modes: &Modes, advice: &Advice) -> Result<Backbones, BuildError> {
    let structure = model.structure;
    let natural = modes.natural().min(modes.shapes.ncols());
    let may_matter = |k: &usize| advice.modes.get(*k).is_some_and(|mode| mode.strain_bound >= advice.tolerance);
    let large: Vec<usize> = (0..natural).filter(may_matter).collect();
    let mut of_modes = vec![None; natural];
    if large.is_empty() || !model.scene.body.has_elements() || !model.scene.output.backbones {
        return Ok(Backbones { of_modes, derivatives: Derivatives::none() });
    }
    let OwnSecondOrder { second, along, inertia } = match structure.own_second_order(modes, &large) {
        Ok(found) => found,
        // The run can do without.
        Err(BuildError::Modal { source: ModalError::StaticNotConverged { .. }, .. }) => {
            return Ok(Backbones { of_modes, derivatives: Derivatives::none() });
        }
        Err(error) => return Err(error),
    };
    let SecondOrder { forces, responses, energies } = second;
    for (j, k) in large.iter().copied().enumerate() {
        let (square, along, shape) = (modes.eigenvalues[k], along[j], modes.shapes.col(k));
        // The derivative is minus the response.
        let (response, force) = (responses.col(j), forces.col(j));
        let relief = force.transpose() * response - square * along * along;
        let (cubic, quartic) = (shape.transpose() * force, 3.0 * (energies[j] - relief));
        of_modes[k] = Some(Backbone::new(square.sqrt(), inertia[j] - along * along, cubic, quartic));
    }
    Ok(Backbones { of_modes, derivatives: Derivatives { modes: large, forces, responses } })
}
