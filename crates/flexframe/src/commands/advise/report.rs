//! The report of the advice on a body.

use std::f64::consts::TAU;

use advice::{Advice, Row, StrainError, Subject};
use model::Model;
use scene::Body;
use serde_json::json;

use super::verify::Real;
use crate::commands::modes::frequency_unit;
use crate::report::{Form, Report, Table, Value};
use crate::rows::effects::is_switch;

/// Advice on an effect, or on another subject of a run.
pub(super) struct Advised<'a> {
    pub subject: Subject,
    pub row: &'a Row,
    /// True if a run of the scene has it; `None` where there is nothing to switch.
    pub on: Option<bool>,
    /// The influence found by running the scene with the effect switched.
    pub real: Option<Real>,
}

impl Advised<'_> {
    /// "on", "off" ("off, may matter" where the scene or its scheme leaves out an effect that counts), or of a subject without a switch
    /// "may matter" or "fine".
    fn verdict(&self) -> &'static str {
        match (self.on, self.row.on) {
            (Some(true), _) => "on",
            (Some(false), true) => "off, may matter",
            (Some(false), false) => "off",
            (None, _) if is_switch(self.subject) => "-",
            (None, true) => "may matter",
            (None, false) => "fine",
        }
    }
}

pub(super) fn body_report(body: &Body, model: &Model, of_paper: bool, rows: &[Advised]) -> Report {
    let (unit, tolerance) = (frequency_unit(&body.units.time), body.effects.tolerance);
    let mut report = Report::new(&body.title);
    report.put("frequency_unit", &unit);
    report.put("tolerance", tolerance);
    report.put("of_paper", of_paper);
    if of_paper {
        report.words("  The effects of the paper's formulation are fixed; this table is for the conservative form.");
    }
    report.words("");
    report.table(effects(rows));
    report.words(format!(
        "\n  Influences are upper bounds, relative to the largest deformation or the angle turned; an effect\n  is on from {tolerance:.0e} \
         (effects.tolerance), or as the scene says.\n"
    ));
    report.table(reasons(rows));
    let large = |k| model.large_modes().contains(&k) && model.static_answer() != Some(k);
    modes(&mut report, &model.advice, &unit, large);
    let refusal = model.refusal.map(|refusal| refusal.to_string());
    if let Some(refusal) = &refusal {
        report.words(format!("\n  This model is refused: {refusal}."));
    }
    report.put("refusal", refusal);
    report
}

fn effects(rows: &[Advised]) -> Table {
    let real = |row: &Advised| match &row.real {
        Some(Real::Difference(real)) => json!({ "difference": Value::from(*real).json() }),
        Some(Real::Fails(reason)) => json!({ "fails": reason }),
        None => Value::NONE.json(),
    };
    let mut table = Table::new("effects", "rows")
        .all()
        .shown("effect", "effect", Form::Plain, rows.iter().map(|row| row.subject.name()))
        .shown("formula", "number", Form::Plain, rows.iter().map(|row| row.subject.formula()))
        .shown("value", "value", Form::Power(1), rows.iter().map(|row| row.row.value))
        .shown("influence", "influence", Form::Power(1), rows.iter().map(|row| row.row.influence))
        .column("advised", rows.iter().map(|row| row.row.on))
        .column("on", rows.iter().map(|row| row.on))
        .column("why", rows.iter().map(|row| &row.row.why))
        .column("real", rows.iter().map(|row| Value::Json(real(row))));
    if rows.iter().any(|row| row.real.is_some()) {
        let real = |row: &Advised| match &row.real {
            Some(Real::Difference(real)) => (*real).into(),
            Some(Real::Fails(_)) => "fails".into(),
            None => Value::NONE,
        };
        table = table.text_only("real", Form::Power(1), rows.iter().map(real));
    }
    table.text_only("verdict", Form::Plain, rows.iter().map(Advised::verdict))
}

/// The reason of each row, and of a failure of the run with it switched.
fn reasons(rows: &[Advised]) -> Table {
    let mut reasons = Vec::new();
    for Advised { subject, row, real, .. } in rows {
        reasons.push((subject.name(), row.why.clone()));
        if let Some(Real::Fails(reason)) = real {
            reasons.push(("", format!("Switched: {reason}")));
        }
    }
    let names: Vec<&str> = reasons.iter().map(|(name, _)| *name).collect();
    let reasons = reasons.into_iter().map(|(_, reason)| reason);
    Table::default().all().text_only("", Form::Plain, names).text_only("", Form::Plain, reasons)
}

/// The worth of each mode, how many to keep, and the error of linear strain where it may matter.
fn modes(report: &mut Report, advice: &Advice, unit: &str, is_large: impl Fn(usize) -> bool) {
    let (modes, kept) = (&advice.modes, advice.keep);
    let keep = modes.iter().enumerate().map(|(k, mode)| match (mode.worth_keeping, k < kept) {
        (true, _) => "yes",
        (false, true) => "yes, with the others",
        (false, false) => "no",
    });
    let strain = modes.iter().map(|mode| {
        let of = |StrainError { deflection, frequency, phase, statics }| {
            Value::of(
                &json!({ "deflection": deflection, "frequency_shift": frequency, "phase": phase, "statics": statics }),
            )
        };
        mode.strain.map(of)
    });
    if !modes.is_empty() {
        report.words("");
    }
    report.table(
        Table::new("modes", "modes")
            .all()
            .text_only("mode", Form::Plain, 1..=modes.len())
            .shown(
                "frequency",
                format!("frequency, {unit}"),
                Form::Fixed(6),
                modes.iter().map(|mode| mode.circular_frequency / TAU),
            )
            .shown("share", "share", Form::Power(1), modes.iter().map(|mode| mode.share))
            .column("worth_keeping", modes.iter().map(|mode| mode.worth_keeping))
            .column("linear_strain", strain)
            .column("large", (0..modes.len()).map(&is_large))
            .text_only("keep", Form::Plain, keep),
    );
    report.put("keep", kept);
    report.put("more_modes", advice.more_modes);
    if !modes.is_empty() {
        let alone = modes.iter().filter(|mode| mode.worth_keeping).count();
        let why = format!(
            ": {alone} for their own share, the others because such a mode comes after them, or because their shares add up"
        );
        let why = if alone < kept { why } else { String::new() };
        let more = if advice.more_modes { "; there may be more, raise modes.flexible or modes.most" } else { "" };
        report.words(format!("\n  Keep the lowest {kept} of {} modes{why}{more}.", modes.len()));
    }
    let strained: Vec<(usize, StrainError)> =
        modes.iter().enumerate().filter_map(|(k, mode)| Some((k, mode.strain?))).collect();
    if strained.is_empty() {
        return;
    }
    let per_cent = |part: fn(&StrainError) -> f64| strained.iter().map(move |(_, strain)| 100.0 * part(strain));
    report.words("");
    report.table(
        Table::default()
            .titled("What linear strain gets wrong at the largest amplitude that is expected of a mode:")
            .all()
            .text_only("mode", Form::Plain, strained.iter().map(|(k, _)| k + 1))
            .text_only("deflection, % of length", Form::Fixed(3), per_cent(|strain| strain.deflection))
            // The error is in the linear frequency.
            .text_only(
                "frequency, %",
                Form::Plain,
                per_cent(|strain| -strain.frequency).map(|error| format!("{error:+.4}")),
            )
            .text_only("phase, rad", Form::Power(3), strained.iter().map(|(_, strain)| strain.phase))
            .text_only("statics, %", Form::Fixed(4), per_cent(|strain| strain.statics))
            .text_only("large", Form::Plain, strained.iter().map(|(k, _)| if is_large(*k) { "yes" } else { "no" })),
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use advice::Worth;
    use dynamics::EffectMap;

    #[test]
    fn the_table_of_modes_shows_as_many_to_keep_as_the_sentence_says() {
        let row = Row { value: 0.0, influence: 0.0, on: false, why: String::new() };
        let mode = |share: f64| Worth {
            circular_frequency: TAU,
            displacement: 0.0,
            share,
            worth_keeping: share >= 1e-3,
            strain_bound: 0.0,
            strain: None,
        };
        let advice = Advice {
            effects: EffectMap::from_fn(|_| row.clone()),
            static_correction: row.clone(),
            large_deflection: row.clone(),
            // The second is kept for the third, the fourth because it and the fifth add up.
            modes: [0.5, 1e-9, 0.1, 6e-4, 6e-4].map(mode).into(),
            keep: 4,
            more_modes: false,
            spin: 0.0,
            deflection: 0.0,
            certain_deflection: 0.0,
            stretch: 0.0,
            pushed: 0.0,
            tolerance: 1e-3,
        };
        let mut report = Report::new("Bar");
        modes(&mut report, &advice, "Hz", |_| false);
        let text = report.to_string();
        let rows: Vec<&str> = text.lines().filter(|line| line.contains("1.000000")).collect();
        assert_eq!(rows.len(), 5, "{text}");
        assert_eq!(rows.iter().filter(|row| row.contains("yes")).count(), 4, "{text}");
        assert!(text.contains("Keep the lowest 4 of 5 modes: 2 for their own share"), "{text}");
    }
}
