//! The trust card of a run: the error of mesh, modes, steps and model, one line each, the worst first.
//!
//! A line has a number where the error is known, the way in which it is, and what would make it smaller. What is not known is
//! said, with the command that would tell: the card is never good in silence.

pub(crate) mod card;
mod full;
mod mesh;
mod steps;

pub(crate) use card::percent;
pub use card::{Place, TrustCard, TrustLine};
pub(crate) use full::model_error;

use model::Model;
use results::Results;
use scene::Scene;

use crate::commands::check::report::CheckReport;
use crate::commands::run::body_report::BodyRunReport;
use card::worst;

/// The card of a run that has come to its end. `check`: the check by the full body, or the reason why there is none; `better`: the
/// cure of large modes that are worse than others.
pub(crate) fn of_run(
    (system, models): (&Scene, &[Model]),
    results: &Results,
    reports: &[BodyRunReport],
    check: Result<&CheckReport, &str>,
    better: Option<&str>,
    file: &str,
) -> TrustCard {
    let name = |number: usize| reports.get(number).filter(|_| reports.len() > 1).map(|report| report.name.clone());
    let mut lines = Vec::new();
    for ((number, model), scene) in models.iter().enumerate().zip(&system.bodies) {
        let scene_file = scene.path.file_name().unwrap_or_default().to_string_lossy();
        let of_steps = reports.get(number).map(|report| steps::line(scene, report, &scene_file));
        lines.extend(of_steps.map(|line| line.of(name(number))));
        lines.push(mesh::line(model, results, number, &scene_file).of(name(number)));
        let of_body = check.map(|check| check.bodies.get(number));
        lines.extend(full::lines(model.body.flexible() == 0, of_body, better, file).map(|line| line.of(name(number))));
    }
    TrustCard { of_bodies: lines.clone(), ..TrustCard::new(worst(lines)) }
}

/// The card in a results file with what a check of it has found since.
pub(crate) fn of_check(results: &Results, check: &CheckReport, file: &str) -> TrustCard {
    let name = |body: &str| results.metadata.only_body().is_none().then(|| body.to_owned());
    let found = check.bodies.iter().zip(&results.metadata.bodies).flat_map(|(body, of)| {
        full::lines(of.model.frequencies.is_empty(), Ok(Some(body)), None, file).map(|line| line.of(name(&body.name)))
    });
    let is_kept = |line: &TrustLine| ![Place::Modes, Place::Model].iter().any(|place| line.place == place.name());
    let kept = TrustCard::of_file(&results.metadata, file).lines.into_iter().filter(is_kept);
    TrustCard::new(worst(kept.chain(found).collect()))
}
