//! The error of the mesh, from the stress of the state with the largest strain energy, and from that of the first mode.
//!
//! The strain energy of the difference between the stress of the elements and the recovered one, over that of the stress, is the
//! part by which the mesh is too stiff (Eq. (S3) of `docs/method/stress.md`): displacements under given forces are too small by it, and
//! a frequency too high by half of that of its mode, Eq. (M15) of `docs/method/modes.md`.

use fem_tet10::{StressError, StressRecovery};
use model::{Meshed, Model};
use results::Results;

use super::card::{Line, Place, SMALL, percent};

/// The line of a body.
pub(super) fn line(model: &Model, results: &Results, body: usize, scene: &str) -> Line {
    let by_frequencies = || format!("`flexframe modes {scene}` states the error of each frequency by the mesh");
    let Some(meshed) = model.meshed.as_ref().filter(|_| model.body.flexible() > 0) else {
        let (meaning, known) = ("no error: a rigid body has no mesh that bends", "by the scene");
        return Place::Mesh.known(0.0, meaning.to_owned(), known.to_owned(), String::new());
    };
    if meshed.elements.is_none() {
        let next = "ask the program that made the matrices, or compare with those of a finer mesh".to_owned();
        return Place::Mesh.not_known("the body is made of matrices, without its elements", next);
    }
    match errors(meshed, results, body) {
        Some([of_state, of_frequency]) => {
            let error = of_state.max(of_frequency);
            let meaning = format!(
                "displacements about {} too small, the first frequency about {} too high",
                percent(of_state),
                percent(of_frequency)
            );
            let known = "estimated from the jumps of stress between elements, at the largest strain energy and in the first mode";
            let next = match error >= SMALL {
                true => "a smaller `mesh_size`, or more elements where the stress is large".to_owned(),
                false => String::new(),
            };
            Place::Mesh.known(error, meaning, known.to_owned(), next)
        }
        None => Place::Mesh.not_known("the body is not deformed in any row", by_frequencies()),
    }
}

/// The part by which the mesh makes a body too stiff in its most deformed row, and that by which its first frequency is too high; `None` where
/// nothing deforms it. A body that a spin stretches has a state that its elements have, and modes that bend them.
fn errors(meshed: &Meshed, results: &Results, body: usize) -> Option<[f64; 2]> {
    let of = results.bodies().nth(body)?;
    let energies = of.numbers("energy/strain")?;
    // About a bent rest the energy is counted from there: it may be below zero.
    let is_strained = |energy: &f64| *energy > 0.0 || meshed.reference.is_some();
    let strained = energies.iter().enumerate().filter(|(_, energy)| is_strained(energy));
    let (row, _) = strained.max_by(|a, b| a.1.total_cmp(b.1))?;
    let q = of.table("modal/displacement")?.row(row)?;
    let elements = meshed.elements.as_ref()?;
    let recovery = StressRecovery::new(&meshed.mesh, &elements.materials).ok()?;
    let of_state = part(&meshed.mesh_error_of_state(&recovery, q).ok()?)?;
    let mut of_mode = None;
    meshed.mesh_errors(&recovery, meshed.modes.shapes.subcols(0, 1), |_, errors| of_mode = part(errors)).ok()?;
    Some([of_state, 0.5 * of_mode?])
}

/// The energy of the error over that of the stress.
fn part(of_elements: &[StressError]) -> Option<f64> {
    let whole: StressError = of_elements.iter().copied().sum();
    (whole.energy > 0.0).then(|| whole.error / whole.energy)
}
