//! How the frequencies of modes that may bend the body far go with their amplitudes.

use advice::{Advice, Backbone};
use modal::{ModalError, Modes};

use crate::error::BuildError;
use crate::reduction::mesh_model::MeshModel;
use crate::structure::kept::{OwnSecondOrder, SecondOrder};

/// The backbones of the natural modes that linear strain may get wrong by the bounds of `advice`; none of others, and none
/// at all where the static responses cannot be found.
///
/// The static modal derivative `Θ = −K⁻¹ g` is made M-orthogonal to its mode φ, so that the modal coordinate stays what
/// it is: with c = φᵀMΘ, its inertia is ΘᵀMΘ − c², its energy −g·Θ − ω²c².
pub(crate) fn backbones(
    model: &MeshModel<'_, '_>,
    modes: &Modes,
    advice: &Advice,
) -> Result<Vec<Option<Backbone>>, BuildError> {
    let structure = model.structure;
    let natural = modes.natural().min(modes.shapes.ncols());
    let may_matter = |k: &usize| advice.modes.get(*k).is_some_and(|mode| mode.strain_bound >= advice.tolerance);
    let large: Vec<usize> = (0..natural).filter(may_matter).collect();
    let mut of_modes = vec![None; natural];
    // Those of a bent body are other ones.
    if large.is_empty() || model.reference.is_some() || !model.scene.source.bends_far() || !model.scene.backbones {
        return Ok(of_modes);
    }
    let OwnSecondOrder { second, along, inertia } = match structure.own_second_order(modes, &large) {
        Ok(found) => found,
        // The run can do without.
        Err(BuildError::Modal { source: ModalError::StaticNotConverged { .. }, .. }) => {
            return Ok(of_modes);
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
    Ok(of_modes)
}
