//! A run to an accuracy that is asked for: the settings are found by the trust card.
//!
//! The scene is run as it stands, and rows are checked by the full nonlinear body. The largest share of the error on the card is mended and the
//! scene run again, until the sum is below the accuracy, or something stops it that no setting mends. The last run that was better than those
//! before it stands. Meshes, modes and static responses that were found are found again in the cache.

mod change;
mod left_out;
mod prices;
mod search;
mod stated;

use std::path::Path;

use model::Model;
use scene::{Body, Choice, Effect, Flexible, Scene};

use crate::commands::run::{self, RunError, RunProgress, RunReport, RunSettings};
pub use prices::{FILES, prices};
use search::Search;

/// Runs a scene to the accuracy of the settings, or else of the scene; without one as it stands. What it was run with at the end is in the
/// report, and the scene in the results file has it.
///
/// # Errors
/// As [`run::run`]. A scene without a body whose elements are known, or with rigid ones alone, is refused.
pub fn run(
    scene: &Scene,
    folder: &Path,
    settings: &RunSettings,
    mut progress: impl FnMut(RunProgress),
) -> Result<(Vec<Model>, RunReport), RunError> {
    let asked = settings.accuracy.or(scene.accuracy);
    let Some(asked) = asked.filter(|_| settings.check) else {
        let (models, mut report) = run::run(scene, folder, settings, progress)?;
        if asked.is_some() {
            let words = "the accuracy was not gone for: the run was made without the check";
            report.warnings.push(words.to_owned());
        }
        return Ok((models, report));
    };
    let bodies = bodies(scene)?;
    let mut search = Search::new(scene, bodies, folder, settings)?;
    let mut best = search.begin(asked, None, false, &mut progress)?;
    let stop = search.go_on(&mut best, &mut progress)?;
    Ok(search.end(best, stop))
}

/// The numbers of the bodies that have a mesh and bend, and the others with the reason.
fn bodies(scene: &Scene) -> Result<(Vec<usize>, Vec<String>), RunError> {
    let why = |body: &Body| -> Option<&str> {
        let is_rigid =
            body.modes.flexible == Flexible::Count(0) || body.effects.choices[Effect::Flexibility] == Choice::Off;
        body.source.not_by_elements().or_else(|| is_rigid.then_some("a body without flexible modes"))
    };
    let with_mesh: Vec<usize> = (0..scene.bodies.len()).filter(|body| why(&scene.bodies[*body]).is_none()).collect();
    let (Some(first), true) = (scene.bodies.first(), with_mesh.is_empty()) else {
        let name = |body: &Body| body.name.clone().unwrap_or_default();
        let left_out = scene.bodies.iter().filter_map(|body| Some(format!("{}: it is {}", name(body), why(body)?)));
        return Ok((with_mesh, left_out.collect()));
    };
    let found = why(first).unwrap_or_default();
    let help = "give the body a mesh and flexible modes, or leave the accuracy out and compare with more modes or a finer model by hand";
    let refused =
        first.refuse("body", found, "a body with a mesh and flexible modes, whose error can be measured", help);
    Err(RunError::Build(refused.into()))
}
