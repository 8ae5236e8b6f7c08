//! `flexframe advise`: which effects a scene calls for, and why.

mod verify;

use std::fmt;

use advice::{Row, StrainError, Subject};
use dynamics::Setup;
use model::{BuildProgress, Builder, Model, Needs};
use scene::{Body, Method};
use serde::{Serialize, Serializer};

use crate::commands::modes::frequency_unit;
use crate::commands::run::RunError;
use crate::files::json;
use crate::rows::effects::{is_on, is_switch};

pub use verify::Real;
pub(crate) use verify::settled;

/// Report of `flexframe advise`.
#[derive(Debug, Clone, Serialize)]
pub struct AdviseReport {
    /// Title of the scene.
    pub title: String,
    /// Unit of frequencies, such as "1/s".
    pub frequency_unit: String,
    /// Relative influence from which an effect is on.
    pub tolerance: f64,
    /// True if the scene's scheme is one of the paper's formulation, whose effects are fixed.
    pub of_paper: bool,
    /// A row for each effect.
    pub rows: Vec<EffectRow>,
    /// Worth of each natural mode.
    pub modes: Vec<ModeRow>,
    /// How many of the modes to keep, the lowest first: the shares of those after them sum to less than the tolerance. More
    /// than are worth it each, where others come before them or add up.
    pub keep: usize,
    /// True if the last mode is still worth keeping, so that more may be.
    pub more_modes: bool,
    /// Known error of the model, if there is one.
    pub refusal: Option<String>,
}

/// Advice on an effect, or on another subject of a run.
#[derive(Debug, Clone, Serialize)]
pub struct EffectRow {
    /// Its subject; as JSON its name.
    #[serde(rename = "effect", serialize_with = "name")]
    pub subject: Subject,
    /// The number that governs it.
    pub formula: &'static str,
    /// The number in this scene; infinite where there is nothing to compare with.
    #[serde(serialize_with = "json::number")]
    pub value: f64,
    /// Estimated relative influence on the answer, an upper bound.
    #[serde(serialize_with = "json::number")]
    pub influence: f64,
    /// True if that reaches the tolerance; of deflection, foreshortening and step if they may matter.
    pub advised: bool,
    /// True if a run of the scene has it; `None` where there is nothing to switch.
    pub on: Option<bool>,
    /// The reason.
    pub why: String,
    /// The influence found by running the scene with the effect switched.
    pub real: Option<Real>,
}

fn name<S: Serializer>(subject: &Subject, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(subject.name())
}

/// Worth of a mode.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct ModeRow {
    /// Cycles per time.
    pub frequency: f64,
    /// Estimated largest share in the deformation, an upper bound.
    #[serde(serialize_with = "json::number")]
    pub share: f64,
    /// True if that reaches the tolerance.
    pub worth_keeping: bool,
    /// Error of linear strain, where that may matter.
    pub linear_strain: Option<LinearStrainRow>,
    /// True if a run of the scene has it among the large modes.
    pub large: bool,
}

/// Error of linear strain in a mode at the amplitude that is expected at most.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct LinearStrainRow {
    /// The amplitude: largest displacement over the length of the body.
    pub deflection: f64,
    /// Change of the frequency that it leaves out, relative.
    pub frequency_shift: f64,
    /// Phase that it is out by at the end of the time that the mode rings, rad.
    pub phase: f64,
    /// Error of the force that holds the mode at that amplitude, relative.
    pub statics: f64,
}

impl From<StrainError> for LinearStrainRow {
    fn from(StrainError { deflection, frequency, phase, statics }: StrainError) -> Self {
        Self { deflection, frequency_shift: frequency, phase, statics }
    }
}

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

/// Tells which effects a scene calls for; with `verify`, also runs it with each effect switched.
///
/// # Errors
/// [`RunError`] of the scene as it is. A run with an effect switched that fails is a row that says so.
pub fn advise(
    body: &Body,
    builder: &Builder,
    verify: bool,
    mut progress: impl FnMut(AdviseProgress),
) -> Result<AdviseReport, RunError> {
    let of_paper = !body.method().abilities.switches_effects;
    let needs = &Needs { method: of_paper.then_some(Method::EXPONENTIAL), ..Needs::without_rows() };
    let assembly = builder.needing(needs.clone()).assemble(body, |p| progress(AdviseProgress::Build(p)))?;
    let mut variants = assembly.variants()?;
    let model = variants.build(body, needs, |p| progress(AdviseProgress::Build(p)))?;
    let step = step_row(body, needs, &model);
    let rows = model.advice.rows().chain([(Subject::Step, &step)]).map(|(subject, row)| EffectRow {
        subject,
        formula: subject.formula(),
        value: row.value,
        influence: row.influence,
        advised: row.on,
        on: is_on(body, &model, subject),
        why: row.why.clone(),
        real: None,
    });
    let mut report = AdviseReport {
        title: body.title.clone(),
        frequency_unit: frequency_unit(&body.units.time),
        tolerance: body.effects.tolerance,
        of_paper,
        rows: rows.collect(),
        modes: (model.advice.modes.iter().enumerate())
            .map(|(k, mode)| ModeRow {
                frequency: mode.circular_frequency / std::f64::consts::TAU,
                share: mode.share,
                worth_keeping: mode.worth_keeping,
                linear_strain: mode.strain.map(LinearStrainRow::from),
                large: model.large_modes().contains(&k) && model.static_answer() != Some(k),
            })
            .collect(),
        keep: model.advice.keep,
        more_modes: model.advice.more_modes,
        refusal: model.refusal.map(|refusal| refusal.to_string()),
    };
    if verify {
        let total = report.rows.iter().filter(|row| row.on.is_some()).count() as u64 + 1;
        progress(AdviseProgress::Verifying { done: 0, total });
        let mut base = verify::Base::new(body, needs, &model, &mut variants)?;
        for (i, row) in report.rows.iter_mut().filter(|row| row.on.is_some()).enumerate() {
            progress(AdviseProgress::Verifying { done: i as u64 + 1, total });
            row.real = Some(base.influence(row.subject));
        }
    }
    Ok(report)
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

impl EffectRow {
    /// "on", "off" ("off, may matter" where the scene or its scheme leaves out what is called for), or of what cannot be
    /// switched "may matter" or "fine".
    fn verdict(&self) -> &'static str {
        match (self.on, self.advised) {
            (Some(true), _) => "on",
            (Some(false), true) => "off, may matter",
            (Some(false), false) => "off",
            (None, _) if is_switch(self.subject) => "-",
            (None, true) => "may matter",
            (None, false) => "fine",
        }
    }
}

impl AdviseReport {
    /// The table of what linear strain gets wrong, where it may get something wrong.
    fn write_linear_strain(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.modes.iter().all(|mode| mode.linear_strain.is_none()) {
            return Ok(());
        }
        writeln!(f, "\n\n  What linear strain gets wrong at the largest amplitude that is expected of a mode:\n")?;
        write!(f, "  mode  deflection, % of length  frequency, %  phase, rad  statics, %  large")?;
        for (k, mode) in self.modes.iter().enumerate() {
            let Some(LinearStrainRow { deflection, frequency_shift, phase, statics }) = mode.linear_strain else {
                continue;
            };
            // The error is that of the linear frequency.
            let [deflection, frequency, statics] = [deflection, -frequency_shift, statics].map(|part| 100.0 * part);
            let large = if mode.large { "yes" } else { "no" };
            write!(
                f,
                "\n  {:>4}  {deflection:>23.3}  {frequency:>+12.4}  {phase:>10.3e}  {statics:>10.4}  {large}",
                k + 1
            )?;
        }
        Ok(())
    }
}

impl fmt::Display for AdviseReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.title)?;
        if self.of_paper {
            writeln!(
                f,
                "  The effects of the paper's formulation are fixed; this table is for the conservative form."
            )?;
        }
        let verified = self.rows.iter().any(|row| row.real.is_some());
        let real = if verified { "      real" } else { "" };
        writeln!(f, "\n  {:<21} {:<29} {:>9} {:>10}{real}  verdict", "effect", "number", "value", "influence")?;
        for row in &self.rows {
            write!(f, "  {:<21} {:<29} {:>9.1e} {:>10.1e}", row.subject.name(), row.formula, row.value, row.influence)?;
            if verified {
                match &row.real {
                    Some(Real::Difference(real)) => write!(f, " {real:>9.1e}")?,
                    Some(Real::Fails(_)) => write!(f, " {:>9}", "fails")?,
                    None => write!(f, " {:>9}", "")?,
                }
            }
            writeln!(f, "  {}", row.verdict())?;
        }
        writeln!(
            f,
            "\n  Influences are upper bounds, relative to the largest deformation or the angle turned; an effect"
        )?;
        writeln!(f, "  is on from {:.0e} (effects.tolerance), or as the scene says.\n", self.tolerance)?;
        for row in &self.rows {
            writeln!(f, "  {:<21} {}", row.subject.name(), row.why)?;
            if let Some(Real::Fails(reason)) = &row.real {
                writeln!(f, "  {:<21} Switched: {reason}", "")?;
            }
        }
        if !self.modes.is_empty() {
            writeln!(f, "\n  mode  frequency, {:<6}     share  keep", self.frequency_unit)?;
            for (k, mode) in self.modes.iter().enumerate() {
                let keep = match (mode.worth_keeping, k < self.keep) {
                    (true, _) => "yes",
                    (false, true) => "yes, with the others",
                    (false, false) => "no",
                };
                writeln!(f, "  {:>4}  {:>17.6}  {:>8.1e}  {keep}", k + 1, mode.frequency, mode.share)?;
            }
            write!(f, "\n  Keep the lowest {} of {} modes", self.keep, self.modes.len())?;
            let alone = self.modes.iter().filter(|mode| mode.worth_keeping).count();
            if alone < self.keep {
                write!(
                    f,
                    ": {alone} for their own share, the others because such a mode comes after them, or because their \
                     shares add up"
                )?;
            }
            let more = if self.more_modes { "; there may be more, raise modes.flexible or modes.most" } else { "" };
            write!(f, "{more}.")?;
        }
        self.write_linear_strain(f)?;
        if let Some(refusal) = &self.refusal {
            write!(f, "\n\n  This model is refused: {refusal}.")?;
        }
        Ok(())
    }
}
