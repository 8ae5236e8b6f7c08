//! How the frequencies of modes that may bend the body far go with their amplitudes.

use advice::{Advice, Backbone};
use faer::Mat;
use modal::{ModalError, Modes};

use super::error::BuildError;
use super::mesh_model::MeshModel;

/// The backbones of the natural modes that linear strain may get wrong by the bounds of `advice`; none of others, and none
/// at all where the static answers cannot be found.
///
/// The static modal derivative `Θ = −K⁻¹ g` is made M-orthogonal to its mode φ, so that the modal coordinate stays what
/// it is: with c = φᵀMΘ, its inertia is ΘᵀMΘ − c², its energy −g·Θ − ω²c².
pub(super) fn backbones(
    model: &MeshModel<'_>,
    modes: &Modes,
    advice: &Advice,
) -> Result<Vec<Option<Backbone>>, BuildError> {
    let solver = model.solver;
    let natural = modes.natural().min(modes.shapes.ncols());
    let may_matter = |k: &usize| advice.modes.get(*k).is_some_and(|mode| mode.strain_bound >= advice.tolerance);
    let large: Vec<usize> = (0..natural).filter(may_matter).collect();
    let mut found = vec![None; natural];
    if large.is_empty() {
        return Ok(found);
    }
    let nodes = modes.shapes.nrows();
    let shapes = Mat::from_fn(nodes, large.len(), |i, j| modes.shapes[(i, large[j])]);
    let pairs: Vec<[usize; 2]> = (0..large.len()).map(|j| [j, j]).collect();
    let quadruples: Vec<[usize; 4]> = (0..large.len()).map(|j| [j; 4]).collect();
    let forces = solver.second_order_forces(shapes.as_ref(), &pairs)?;
    let energies = solver.second_order_energies(shapes.as_ref(), &quadruples)?;
    let answers = match solver.static_response(forces.as_ref()) {
        Ok(answers) => answers,
        // The run can do without.
        Err(BuildError::Modal { source: ModalError::StaticNotConverged { .. }, .. }) => return Ok(found),
        Err(error) => return Err(error),
    };
    let momenta = solver.mass_product(answers.as_ref())?;
    for (j, k) in large.into_iter().enumerate() {
        let square = modes.eigenvalues[k];
        // The derivative is minus the answer.
        let (shape, answer, force) = (shapes.col(j), answers.col(j), forces.col(j));
        let along = shape.transpose() * momenta.col(j);
        let inertia = answer.transpose() * momenta.col(j) - along * along;
        let relief = force.transpose() * answer - square * along * along;
        let (cubic, quartic) = (shape.transpose() * force, 3.0 * (energies[j] - relief));
        found[k] = Some(Backbone::new(square.sqrt(), inertia, cubic, quartic));
    }
    Ok(found)
}
