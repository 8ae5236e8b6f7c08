//! `flexframe cost`: what accuracy costs, measured on the user's own scene.
//!
//! Every method runs at a ladder of steps or tolerances. Each run is compared with a reference at up to 100 equally
//! spaced times and timed several times. The modes are an axis of their own: the same motion with fewer and more of
//! them shows what those left out would change.

mod answer;
mod body;
mod case;
mod files;
mod ladder;
mod machine;
mod modes;
mod reference;
mod report;
mod run;
mod setting;
mod settings;
mod short;

use std::path::Path;

use advice::Subject;
use diagnostic::{Diagnostic, Failure};
use dynamics::{Method, SystemScheme};
use model::{BuildError, BuildProgress, Builder, ModeCount, Model, Needs};
use scene::{Body, METHODS, Scene};

pub use answer::Answer;
pub use body::CostBody;
pub use files::files;
pub use ladder::{LadderRun, Line, MeasuredRun, Outcome, Stopped};
pub use machine::Machine;
pub use modes::{ModesRow, modes_warning};
pub use reference::ReferenceReport;
pub use report::CostReport;
pub use run::Errors;
pub use setting::Setting;
pub use settings::CostSettings;
pub use short::{duration, setting};

use crate::commands::run::RunBody;
pub use crate::commands::run::RunFailure;

use crate::commands::advise::settled;
use answer::refine;
use case::PreparedScene;
use ladder::{Evaluator, refine_line};
use reference::{Reference, converge};

/// How far a price list has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CostProgress {
    /// The model is being built.
    Build(BuildProgress),
    /// Runs are being measured.
    Measuring {
        /// Parts of the list that are done.
        done: u64,
        /// Parts of the list.
        total: u64,
    },
}

/// Measures what accuracy costs on the bodies of a scene, and writes `cost.csv`, and `work_precision` as SVG, PDF and PNG to
/// `folder`. An error is that of the worst body, a time that of all of them.
///
/// # Errors
/// [`Failure`]. A run that fails is a row that says so.
pub fn price_list(
    scene: &Scene,
    builder: &Builder,
    folder: &Path,
    settings: CostSettings,
    mut progress: impl FnMut(CostProgress),
) -> Result<CostReport, Failure> {
    let builder = &builder.needing(Needs::without_rows());
    let built = scene.bodies.iter().map(|given| Built::new(given, builder, |p| progress(CostProgress::Build(p))));
    let built = built.collect::<Result<Vec<_>, _>>()?;
    let case = PreparedScene::new(scene.clone(), built.iter().map(|built| &built.model).collect());

    let is_tied = scene.has_ties();
    let methods: &[Method] = if is_tied { &Method::OF_JOINTS } else { &METHODS };
    let ladders: Vec<(Method, bool)> = methods
        .iter()
        .flat_map(|method| [(*method, false), (*method, true)])
        .filter(|(method, controlled)| !controlled || method.estimates_error)
        .collect();
    let total = (ladders.len() + 2 + built.len()) as u64;
    let mut done = 0;
    let mut step = |parts: u64| {
        done += parts;
        progress(CostProgress::Measuring { done, total });
    };
    step(0);
    let finest = if is_tied { Method::of_joints(SystemScheme::default()) } else { Method::EXPONENTIAL };
    let reference = converge(&case, finest, settings.budget(20), 0.0).map_err(|(steps, source)| {
        let words =
            format!("no reference can be made: a run of {steps} steps of the exponential scheme failed: {source}");
        let known = source.diagnosis().in_file(&scene.path);
        known.help("make the run shorter, or give more time with --patience").says(words)
    })?;
    step(1);
    // The paper's formulation has a limit of its own, to which its schemes converge.
    let limit = (!is_tied).then(|| converge(&case, frames_rk4::LIMIT, settings.budget(5), 0.0));
    let (paper_limit, paper_limit_failure) = match limit {
        Some(Ok(limit)) => (Some(limit), None),
        Some(Err((steps, failure))) => (None, Some(format!("in {steps} steps: {failure}"))),
        None => (None, Some("the paper's form has no joints".to_owned())),
    };
    step(1);
    let evaluator = Evaluator { reference: &reference, paper_limit: paper_limit.as_ref(), settings };
    let own = (*scene.method(), scene.time.control);
    let mut lines = Vec::new();
    for (method, controlled) in ladders {
        lines.push(refine_line(&case, &evaluator, method, controlled, own));
        step(1);
    }
    if let Some(target) = settings.target {
        refine(&case, &evaluator, &mut lines, target);
    }
    ladder::mark_front(&mut lines);
    let of_body = |(body, built): (RunBody<'_>, &Built)| {
        let of_body = built.report(body, &settings);
        step(1);
        of_body
    };
    let bodies: Vec<CostBody> = case.bodies().zip(&built).map(of_body).collect();

    let mut report = CostReport {
        title: scene.title.clone(),
        scene: scene.path.clone(),
        time_unit: scene.units.time.clone(),
        machine: Machine::this(),
        end: scene.time.end,
        reference: reference.report(),
        paper_limit: paper_limit.as_ref().map(|limit| limit.report_against(&reference, case.scales())),
        paper_limit_failure,
        answer: settings.target.map(|target| Answer::new(target, scene.rows, &lines, &bodies)),
        lines,
        bodies,
        files: Vec::new(),
    };
    report.files = files::write(&report, folder)?;
    Ok(report)
}

/// A body that is built.
struct Built {
    model: Model,
    /// Its models with more and more modes, with the same effects for any number. They have no static shapes, which stand for modes that
    /// are left out.
    with_modes: Vec<Model>,
}

impl Built {
    fn new(body: &Body, builder: &Builder, mut progress: impl FnMut(BuildProgress)) -> Result<Self, BuildError> {
        let assembly = builder.assemble(body, &mut progress)?;
        let mut variants = assembly.variants()?;
        let model = variants.build(body, &builder.needs, &mut progress)?;
        let settled = settled(&builder.needs, body, &model, Some((Subject::StaticCorrection, false)));
        let mut with_modes = Vec::new();
        let counts = if body.tied { Vec::new() } else { modes::counts(Self::flexible(&model), variants.available()?) };
        for count in counts.into_iter().rev() {
            let needs = Needs { flexible: Some(ModeCount::Count(count)), ..settled.clone() };
            with_modes.insert(0, variants.build(body, &needs, &mut progress)?);
        }
        Ok(Self { model, with_modes })
    }

    fn flexible(model: &Model) -> usize {
        model.body.flexible() - model.static_shapes()
    }

    fn report(&self, body: RunBody<'_>, settings: &CostSettings) -> CostBody {
        let compared = (!body.body.tied).then(|| modes::compare(body.body, &self.with_modes, settings));
        let (modes, modes_failure) = match compared {
            None => (Vec::new(), Some(TIED_MODES.to_owned())),
            Some(Ok(modes)) => (modes, None),
            Some(Err((count, failure))) => (Vec::new(), Some(format!("with {count} modes: {failure}"))),
        };
        CostBody {
            name: body.name().to_owned(),
            flexible: Self::flexible(&self.model),
            highest_frequency: self.model.natural_frequencies().into_iter().reduce(f64::max),
            initial_spin: nalgebra::Vector3::from(body.body.initial.angular_velocity).norm(),
            points: self.model.points.len(),
            modes,
            modes_failure,
        }
    }
}

/// Reason that the modes of a tied body are not compared.
const TIED_MODES: &str = "the body is tied to others: give it other `modes.flexible` to see what they change";

impl Reference {
    fn report(&self) -> ReferenceReport {
        ReferenceReport { step: self.step, steps: self.steps, own_error: self.error, errors: None }
    }

    fn report_against(&self, other: &Self, scales: &[run::Scales]) -> ReferenceReport {
        let errors = Errors::between(&self.trajectory, &other.trajectory, scales);
        ReferenceReport { errors: Some(errors), ..self.report() }
    }
}
