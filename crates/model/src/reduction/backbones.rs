//! How the frequencies of modes that may bend the body far go with their amplitudes.

use advice::{Advice, Backbone};
use faer::{ColRef, Mat};
use modal::{ModalError, Modes, StaticAccuracy};

use crate::error::BuildError;
use crate::reduction::mesh_model::{MeshModel, shapes_of};

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
    answers: Mat<f64>,
}

impl Derivatives {
    fn none() -> Self {
        Self { modes: Vec::new(), forces: Mat::new(), answers: Mat::new() }
    }

    /// The force of a mode and its answer, if they are known.
    pub fn of_mode(&self, mode: usize) -> Option<[ColRef<'_, f64>; 2]> {
        let k = self.modes.iter().position(|known| *known == mode)?;
        Some([self.forces.col(k), self.answers.col(k)])
    }
}

/// The backbones of the natural modes that linear strain may get wrong by the bounds of `advice`; none of others, and none
/// at all where the static responses cannot be found.
///
/// The static modal derivative `Θ = −K⁻¹ g` is made M-orthogonal to its mode φ, so that the modal coordinate stays what
/// it is: with c = φᵀMΘ, its inertia is ΘᵀMΘ − c², its energy −g·Θ − ω²c².
pub(crate) fn backbones(model: &MeshModel<'_>, modes: &Modes, advice: &Advice) -> Result<Backbones, BuildError> {
    let solver = model.solver;
    let natural = modes.natural().min(modes.shapes.ncols());
    let may_matter = |k: &usize| advice.modes.get(*k).is_some_and(|mode| mode.strain_bound >= advice.tolerance);
    let large: Vec<usize> = (0..natural).filter(may_matter).collect();
    let mut of_modes = vec![None; natural];
    if large.is_empty() || !model.scene.body.has_elements() || !model.scene.output.backbones {
        return Ok(Backbones { of_modes, derivatives: Derivatives::none() });
    }
    let shapes = shapes_of(modes, &large);
    let pairs: Vec<[usize; 2]> = (0..large.len()).map(|j| [j, j]).collect();
    let quadruples: Vec<[usize; 4]> = (0..large.len()).map(|j| [j; 4]).collect();
    let forces = solver.second_order_forces(shapes.as_ref(), &pairs)?;
    let energies = solver.second_order_energies(shapes.as_ref(), &quadruples)?;
    let answers = match solver.static_response(modes, forces.as_ref(), StaticAccuracy::Shapes) {
        Ok(answers) => answers,
        // The run can do without.
        Err(BuildError::Modal { source: ModalError::StaticNotConverged { .. }, .. }) => {
            return Ok(Backbones { of_modes, derivatives: Derivatives::none() });
        }
        Err(error) => return Err(error),
    };
    let momenta = solver.mass_product(answers.as_ref())?;
    for (j, k) in large.iter().copied().enumerate() {
        let square = modes.eigenvalues[k];
        // The derivative is minus the answer.
        let (shape, answer, force) = (shapes.col(j), answers.col(j), forces.col(j));
        let along = shape.transpose() * momenta.col(j);
        let inertia = answer.transpose() * momenta.col(j) - along * along;
        let relief = force.transpose() * answer - square * along * along;
        let (cubic, quartic) = (shape.transpose() * force, 3.0 * (energies[j] - relief));
        of_modes[k] = Some(Backbone::new(square.sqrt(), inertia, cubic, quartic));
    }
    Ok(Backbones { of_modes, derivatives: Derivatives { modes: large, forces, answers } })
}
