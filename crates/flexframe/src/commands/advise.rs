//! `flexframe advise`: which effects a scene calls for, and why.

mod report;
mod verify;

use advice::{Row, Subject};
use diagnostic::Failure;
use dynamics::Setup;
use model::{BuildProgress, Builder, Model, Needs};
use report::{Advised, body_report};
use scene::{Body, Method, Scene};

use crate::commands::system_modes::system_advice;
use crate::report::Report;
use crate::rows::effects::is_on;

pub(crate) use verify::settled;

/// How far the advice has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AdviseProgress {
    /// A model is being built.
    Build(BuildProgress),
    /// Runs with an effect switched, done of all.
    Verifying {
        /// Done.
        done: u64,
        /// All.
        total: u64,
    },
}

/// Tells which effects each body of a scene calls for, and what the vibrations of bodies in joints say; with `verify`, also runs each
/// body with each effect switched.
///
/// # Errors
/// [`Failure`] of the scene as it is. A run with an effect switched that fails is a row that says so.
pub fn advise(
    scene: &Scene,
    builder: &Builder,
    verify: bool,
    mut progress: impl FnMut(AdviseProgress),
) -> Result<Report, Failure> {
    let of_body = |body: &Body| Ok((body.name.clone(), advise_body(body, builder, verify, &mut progress)?));
    let bodies = scene.bodies.iter().map(of_body).collect::<Result<Vec<_>, Failure>>()?;
    if !scene.has_connections() {
        return Ok(Report::of_bodies(bodies));
    }
    let mut report = Report::default();
    report.list("bodies", bodies);
    let systems = system_advice(scene, builder, |p| progress(AdviseProgress::Build(p)))?;
    report.list("systems", systems.into_iter().map(|system| (None, system)).collect());
    Ok(report)
}

fn advise_body(
    body: &Body,
    builder: &Builder,
    verify: bool,
    mut progress: impl FnMut(AdviseProgress),
) -> Result<Report, Failure> {
    let of_paper = !body.method().abilities.switches_effects;
    let needs = &Needs { method: of_paper.then_some(Method::EXPONENTIAL), ..Needs::without_rows() };
    let assembly = builder.needing(needs.clone()).assemble(body, |p| progress(AdviseProgress::Build(p)))?;
    let mut variants = assembly.variants()?;
    let model = variants.build(body, needs, |p| progress(AdviseProgress::Build(p)))?;
    let step = step_row(body, needs, &model);
    let rows = model.advice.rows().chain([(Subject::Step, &step)]);
    let mut rows: Vec<Advised> =
        rows.map(|(subject, row)| Advised { subject, row, on: is_on(body, &model, subject), real: None }).collect();
    if verify {
        let total = rows.iter().filter(|row| row.on.is_some()).count() as u64 + 1;
        progress(AdviseProgress::Verifying { done: 0, total });
        let mut base = verify::Base::new(body, needs, &model, &mut variants)?;
        for (i, row) in rows.iter_mut().filter(|row| row.on.is_some()).enumerate() {
            progress(AdviseProgress::Verifying { done: i as u64 + 1, total });
            row.real = Some(base.influence(row.subject));
        }
    }
    Ok(body_report(body, &model, of_paper, &rows))
}

/// Error of the steps; that of a step that no run can start with is infinite.
fn step_row(body: &Body, needs: &Needs, model: &Model) -> Row {
    let (tolerance, initial) = (body.effects.tolerance, model.initial(body));
    let method = needs.method_of(body);
    match advice::step_estimate(&Setup { method: model.paper.or(&method), ..model.setup(body, &initial) }) {
        Ok(Some(estimate)) => estimate.row(tolerance),
        Ok(None) => {
            let why = "The step follows from the tolerance.".into();
            Row { value: 0.0, influence: 0.0, on: false, why }
        }
        Err(error) => {
            let why = format!("No run can start: {error}.");
            Row { value: 0.0, influence: 1.0, on: true, why }
        }
    }
}
