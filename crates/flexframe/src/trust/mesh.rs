//! The error of the mesh, from the stress of the state with the largest strain energy.
//!
//! The strain energy of the difference between the stress of the elements and the recovered one, over that of the stress, is the
//! part by which the mesh is too stiff (Eq. (S3) of `docs/method/stress.md`): displacements under given forces are too small by it, and
//! frequencies too high by half of it, Eq. (M15) of `docs/method/modes.md`.

use faer::Col;
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
    match stiffness_error(meshed, results, body) {
        Some(error) => {
            let meaning = format!(
                "displacements about {} too small, frequencies about {} too high",
                percent(error),
                percent(0.5 * error)
            );
            let known = "estimated from the jumps of stress between elements, at the largest strain energy";
            let next = match error >= SMALL {
                true => "a smaller `mesh_size`, or more elements where the stress is large".to_owned(),
                false => String::new(),
            };
            Place::Mesh.known(error, meaning, known.to_owned(), next)
        }
        None => Place::Mesh.not_known("the body is not deformed in any row", by_frequencies()),
    }
}

/// The part by which the mesh makes a body too stiff in its most deformed row; `None` where nothing deforms it.
fn stiffness_error(meshed: &Meshed, results: &Results, body: usize) -> Option<f64> {
    let of = results.bodies().nth(body)?;
    let energies = of.numbers("energy/strain")?;
    let (row, _) =
        energies.iter().enumerate().filter(|(_, energy)| **energy > 0.0).max_by(|a, b| a.1.total_cmp(b.1))?;
    let q = of.table("modal/displacement")?.row(row)?;
    let displacement = &meshed.modes.shapes * Col::from_iter(q.iter().copied());
    let elements = meshed.elements.as_ref()?;
    let recovery = StressRecovery::new(&meshed.mesh, &elements.materials).ok()?;
    let nodal = recovery.nodal_stress(displacement.as_mat()).ok()?;
    let energies = recovery.error_estimate(displacement.as_ref(), nodal.col(0)).ok()?;
    let whole: StressError = energies.into_iter().sum();
    (whole.energy > 0.0).then(|| whole.error / whole.energy)
}
