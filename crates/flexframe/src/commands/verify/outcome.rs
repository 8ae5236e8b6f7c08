//! Published values beside ours.

use diagnostic::{CURE, Failure};
use report::{Form, Report, Table, quantity};

use super::case::{Case, Quantity, Tolerance};
use super::found::Answer;

/// Letters of a source in a line of text.
const SOURCE: usize = 40;

/// A published value and ours.
#[derive(Debug, Clone)]
pub(super) struct Outcome {
    pub quantity: Quantity,
    /// None where the case could not be answered.
    pub ours: Option<f64>,
    /// The relative error that the report states.
    pub stated: Option<f64>,
    /// Reason that there is no answer.
    pub failure: Option<String>,
}

/// The verdict on an outcome.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Verdict {
    /// Within the tolerance.
    Pass,
    /// Beyond the tolerance, or no answer, with a reason in the case.
    KnownMiss,
    /// The same without.
    Miss,
}

impl Outcome {
    /// All values of a case.
    pub fn all(case: &Case, answer: &Answer) -> Result<Vec<Self>, Failure> {
        let of = |quantity: Quantity| {
            let ours = Some(answer.value(case, &quantity)?);
            Ok(Self { ours, stated: answer.stated(&quantity), quantity, failure: None })
        };
        case.quantities().map(of).collect()
    }

    /// The same without an answer.
    pub fn none(case: &Case, failure: &Failure) -> Vec<Self> {
        let words = failure.to_string();
        let of = |quantity| Self { quantity, ours: None, stated: None, failure: Some(words.clone()) };
        case.quantities().map(of).collect()
    }

    /// The difference in the form of the tolerance.
    pub fn difference(&self) -> Option<f64> {
        let Quantity { published, tolerance, .. } = &self.quantity;
        self.ours.map(|ours| match tolerance {
            Tolerance::Relative(_) => (ours - published) / published.abs(),
            Tolerance::Absolute(_) => ours - published,
        })
    }

    /// The largest difference that passes.
    pub fn tolerance(&self) -> f64 {
        let (Tolerance::Relative(most) | Tolerance::Absolute(most)) = self.quantity.tolerance;
        most
    }

    /// The verdict on it.
    pub fn verdict(&self) -> Verdict {
        match (self.difference(), &self.quantity.miss) {
            (Some(difference), _) if difference.abs() <= self.tolerance() => Verdict::Pass,
            (_, Some(_)) => Verdict::KnownMiss,
            (_, None) => Verdict::Miss,
        }
    }

    /// A difference or a tolerance, in per cent where it is relative.
    pub fn in_words(&self, value: f64) -> String {
        match self.quantity.tolerance {
            Tolerance::Relative(_) if value.abs() >= 1e-5 || value == 0.0 => format!("{} %", rounded(100.0 * value)),
            Tolerance::Relative(_) => format!("{value:.1e}"),
            Tolerance::Absolute(_) => rounded(value),
        }
    }
}

impl Verdict {
    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Pass => "pass",
            Self::KnownMiss => "miss (known)",
            Self::Miss => "miss",
        }
    }
}

/// Two digits.
fn rounded(value: f64) -> String {
    let text = format!("{value:.1e}");
    match text.parse::<f64>() {
        Ok(value) if (1e-3..1e4).contains(&value.abs()) => quantity(value),
        _ => text,
    }
}

/// A name with its unit.
pub(super) fn labelled(name: &str, unit: &str) -> String {
    if unit.is_empty() { name.to_owned() } else { format!("{name}, {unit}") }
}

/// The first words of a source.
fn shortened(source: &str) -> String {
    let short: String = source.chars().take(SOURCE).collect();
    if short.len() < source.len() { format!("{}…", short.trim_end()) } else { short }
}

/// The report of all outcomes.
pub(super) fn report(cases: &[Case], outcomes: &[Vec<Outcome>]) -> Report {
    let all = || cases.iter().zip(outcomes).flat_map(|(case, of)| of.iter().map(move |outcome| (case, outcome)));
    let of = || all().map(|(_, outcome)| outcome);
    let is_relative = |outcome: &Outcome| matches!(outcome.quantity.tolerance, Tolerance::Relative(_));
    let count = |verdict: Verdict| of().filter(|outcome| outcome.verdict() == verdict).count();
    let [passed, known, missed] = [Verdict::Pass, Verdict::KnownMiss, Verdict::Miss].map(count);
    let mut report = Report::new("Published benchmarks");
    report.put("passed", passed);
    report.put("known_misses", known);
    report.put("misses", missed);
    report.line("cases", format!("{}: {passed} numbers pass, {known} are known misses, {missed} miss", cases.len()));
    report.table(
        Table::new("benchmarks", "benchmarks")
            .all()
            .shown("case", "case", Form::Plain, all().map(|(case, _)| &case.name))
            .shown("quantity", "quantity", Form::Plain, of().map(|of| &of.quantity.label))
            .shown("unit", "", Form::Plain, of().map(|of| &of.quantity.unit))
            .shown("theirs", "theirs", Form::Plain, of().map(|of| of.quantity.published))
            .shown("ours", "ours", Form::Plain, of().map(|of| of.ours))
            .column("difference", of().map(Outcome::difference))
            .column("tolerance", of().map(Outcome::tolerance))
            .column("relative", of().map(is_relative))
            .text_only("difference", Form::Plain, of().map(|of| of.difference().map(|value| of.in_words(value))))
            .text_only("tolerance", Form::Plain, of().map(|of| of.in_words(of.tolerance())))
            .column("stated", of().map(|of| of.stated))
            .text_only(
                "stated",
                Form::Plain,
                of().map(|of| of.stated.map(|part| format!("{} %", rounded(100.0 * part)))),
            )
            .shown("verdict", "", Form::Plain, of().map(|of| of.verdict().name()))
            .column("reason", of().map(|of| of.quantity.miss.clone()))
            .text_only("source", Form::Plain, all().map(|(case, _)| shortened(&case.source)))
            .column("source", all().map(|(case, _)| &case.source))
            .column("title", all().map(|(case, _)| &case.title))
            .column("kind", all().map(|(case, _)| &case.kind))
            .column("note", all().map(|(case, _)| &case.note)),
    );
    for (case, of) in cases.iter().zip(outcomes) {
        report.warnings.extend(warnings(case, of));
    }
    report
}

/// Reasons of a case that has no answer, and of misses; misses that are none any more.
fn warnings(case: &Case, outcomes: &[Outcome]) -> Vec<String> {
    let name = &case.name;
    if let Some(failure) = outcomes.iter().find_map(|of| of.failure.as_ref()) {
        return vec![format!("{name}: {}", failure.replace(CURE, "; "))];
    }
    let mut reasons: Vec<String> = Vec::new();
    for Outcome { quantity, .. } in outcomes.iter().filter(|of| of.verdict() == Verdict::KnownMiss) {
        let reason = format!("{name}: a miss: {}", quantity.miss.as_deref().unwrap_or_default());
        if !reasons.contains(&reason) {
            reasons.push(reason);
        }
    }
    let passes = |line: usize| {
        outcomes.iter().filter(move |of| of.quantity.line == line).all(|of| of.verdict() == Verdict::Pass)
    };
    let mut of_passes = outcomes.iter().filter(|of| of.quantity.miss.is_some() && passes(of.quantity.line));
    reasons.extend(of_passes.next().map(|of| {
        let line = of.quantity.line;
        format!("{name}: line {line} of its case names a reason for a miss, and passes: take the reason out")
    }));
    reasons
}

/// The list of cases.
pub(super) fn list(cases: &[Case]) -> Report {
    let mut report = Report::new("Published benchmarks");
    report.table(
        Table::new("cases", "cases")
            .all()
            .shown("case", "case", Form::Plain, cases.iter().map(|case| &case.name))
            .shown("kind", "kind", Form::Plain, cases.iter().map(|case| &case.kind))
            .column("quick", cases.iter().map(|case| case.quick))
            .text_only("", Form::Plain, cases.iter().map(|case| if case.quick { "quick" } else { "" }))
            .shown("title", "title", Form::Plain, cases.iter().map(|case| &case.title))
            .column("source", cases.iter().map(|case| &case.source)),
    );
    report
}
