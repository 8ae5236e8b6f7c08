//! The static answer to the moments on a body, as a large coordinate: Eq. (G5) of `docs/method/stiffening.md`.
//!
//! A moment works on the angle of its patch, of which no mode has the right share: with the modes alone large a rod that an end
//! moment turns by half a radian is off by 3 %. With what its answer has beside these as one more direction the manifold holds the whole
//! bent rod.

use advice::Advice;
use faer::{Col, Mat};
use modal::Modes;

use crate::error::{BuildError, modal};
use crate::load::mesh_load::Action;
use crate::reduction::bent::Bent;
use crate::reduction::mesh_model::MeshModel;
use crate::reduction::physics;

/// Least part of the answer beside the large modes: of less, these hold it.
const LEAST: f64 = 0.01;
/// Least size of the answer over the largest coordinate that is expected. Below it other loads bend the body, whose motion the answer does not improve.
const PART: f64 = 0.3;

/// Modes of which one coordinate is what the answer to the moments has beside the large modes, with those that bend the body then.
pub(crate) struct WithAnswer {
    pub modes: Modes,
    pub bent: Bent,
}

impl WithAnswer {
    /// `None` where no moment bends the body far beside its large modes; where moments go by several histories; where other bodies may, in joints; of a body that is bent in its
    /// reference already; and where the scene begins with amplitudes of modes, which are those of the modes themselves.
    pub fn new(
        model: &MeshModel<'_, '_>,
        modes: &Modes,
        bent: &Bent,
        advice: &Advice,
    ) -> Result<Option<Self>, BuildError> {
        let scene = model.scene;
        let begins_bent = !scene.initial.modal_displacement.is_empty() || !scene.initial.modal_velocity.is_empty();
        let has_room = !bent.large.is_empty() && bent.large.len() < dynamics::MAX_LARGE;
        if !has_room || begins_bent || !model.markers.is_empty() || model.reference.is_some() {
            return Ok(None);
        }
        let Some(amplitudes) = amplitudes(model, modes) else { return Ok(None) };
        let size = amplitudes.iter().map(|c| c * c).sum::<f64>().sqrt();
        let expected = bent.large.iter().filter_map(|k| advice.modes.get(*k)).map(|mode| mode.displacement);
        if size == 0.0 || size < PART * expected.fold(0.0, f64::max) {
            return Ok(None);
        }
        let found = modes.with_answer(&amplitudes, &bent.large, LEAST).map_err(modal(scene))?;
        Ok(found.map(|modes| {
            let mut large: Vec<usize> =
                bent.large.iter().copied().chain(modes.answer.iter().map(|of| of.place)).collect();
            large.sort_unstable();
            let following = physics::following(scene, &modes.eigenvalues[..modes.natural()], &large);
            Self { modes, bent: Bent { large, following } }
        }))
    }
}

/// The static answer to all moments together, at their largest and in their first directions, in the modes; `None` without moments, and
/// of those that do not go by one history, which have no answer together.
fn amplitudes(model: &MeshModel<'_, '_>, modes: &Modes) -> Option<Vec<f64>> {
    let moments: Vec<_> = model.loads.iter().filter(|load| matches!(load.action, Action::Moment { .. })).collect();
    let first = moments.first()?;
    if moments.iter().any(|load| load.history != first.history) {
        return None;
    }
    let mut forces = Mat::<f64>::zeros(modes.shapes.nrows(), 1);
    for load in moments {
        let mut unit = Mat::zeros(forces.nrows(), 1);
        load.add_unit_nodal_forces(None, unit.col_mut(0));
        let size = load.size() * load.history.largest(model.scene.time.end);
        forces += unit * faer::Scale(size);
    }
    let along: Col<f64> = modes.shapes.transpose() * forces.col(0);
    Some(along.iter().zip(&modes.eigenvalues).map(|(force, lambda)| force / lambda).collect())
}
