//! The accuracy of a run: what was asked for, what was found for it, and what that cost.

use std::fmt;

use serde::{Serialize, Serializer};

use crate::report::{Form, Report, Table};
use crate::trust::percent;

/// The accuracy of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AccuracyReport {
    /// The error that the answer may have, relative.
    pub asked: f64,
    /// The error that the trust card states of it: the sum of its lines, of the worst body, point or stress. `None` where it is not known.
    pub stated: Option<f64>,
    /// The answer that has this error.
    pub of: String,
    /// True if the stated error is below the one asked for, and no row tells against it.
    pub reached: bool,
    /// The end of a search that has not reached it; `None` where the accuracy is reached.
    pub stopped_by: Option<StoppedBy>,
    /// The same in words, with a cure.
    pub why: Option<String>,
    /// Angle by which the mesh alone shifts the first vibration by the end of the run at the most, rad: at equal phase the answer is as stated.
    pub mesh_phase: Option<f64>,
    /// Bodies that the stated error is not of, with the reason.
    pub left_out: Vec<String>,
    /// The runs.
    pub rounds: Vec<Round>,
    /// The settings that were found, as TOML for the scene; empty where it stays as it is.
    pub settings: String,
}

/// A run of the search.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Round {
    /// The change of the settings.
    pub change: String,
    /// The stated error before it; `None` where that is not known.
    pub before: Option<f64>,
    /// The stated error with it.
    pub after: Option<f64>,
    /// The largest share of that: the line of the trust card, or the reason that the run failed.
    pub largest: String,
    /// True if the change was kept.
    pub kept: bool,
    /// Seconds of the run, with its model and its check.
    pub seconds: f64,
}

/// The end of a search that has not reached the accuracy.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StoppedBy {
    /// The elements.
    Mesh,
    /// The shapes: more of them do not help.
    Modes,
    /// The steps in time.
    Steps,
    /// The equations have linear strain alone.
    LinearStrain,
    /// The body bends further than its model holds.
    Model,
    /// The full body is unstable on the way.
    Instability,
    /// A part of the error that is not known.
    NotKnown,
    /// The number of runs.
    Rounds,
}

impl Round {
    /// The change of a run that is made to compare, and never kept.
    pub const TO_COMPARE: &str = "twice the modes, to compare";

    /// True if the answer has the error that is stated after the round.
    fn counts(&self) -> bool {
        self.kept || self.change == Self::TO_COMPARE
    }
}

impl StoppedBy {
    /// Its name in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mesh => "mesh",
            Self::Modes => "modes",
            Self::Steps => "steps",
            Self::LinearStrain => "linear-strain",
            Self::Model => "model",
            Self::Instability => "instability",
            Self::NotKnown => "not-known",
            Self::Rounds => "rounds",
        }
    }
}

impl Serialize for StoppedBy {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.name().serialize(serializer)
    }
}

impl fmt::Display for AccuracyReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut report = Report::default();
        let stated = self.stated.map_or_else(|| "not known".to_owned(), |stated| format!("{} stated", percent(stated)));
        let reached = if self.reached { "reached" } else { "not reached" };
        let asked = percent(self.asked);
        report.line("accuracy", format!("{reached}: {asked} asked for, {stated} ({})", self.of));
        self.why.iter().for_each(|why| report.line("", format!("stopped by {why}")));
        if let Some(angle) = self.mesh_phase.filter(|angle| *angle > 0.0) {
            let degrees = angle.to_degrees();
            report.line(
                "",
                format!("at equal phase: the mesh shifts the first vibration by up to {degrees:.2}° by the end"),
            );
        }
        self.left_out.iter().for_each(|body| report.line("", format!("without {body}")));
        let rounds = |of: fn(&Round) -> String| self.rounds.iter().map(of);
        let after = |round: &Round| round.after.map(percent).or_else(|| round.kept.then(|| "not known".to_owned()));
        let table = Table::new("", None)
            .titled("what was chosen, what it bought, what it cost")
            .all()
            .text_only("change", Form::Plain, rounds(|round| round.change.clone()))
            .text_only("before", Form::Plain, self.rounds.iter().map(|round| round.before.map(percent)))
            .text_only("stated", Form::Plain, self.rounds.iter().map(after))
            .text_only("most by", Form::Plain, rounds(|round| round.largest.clone()))
            .text_only("", Form::Plain, rounds(|round| if round.counts() { "" } else { "taken back" }.to_owned()))
            .text_only("seconds", Form::Fixed(2), self.rounds.iter().map(|round| round.seconds));
        report.table(table);
        if !self.settings.is_empty() {
            report.words("  the same alone, by these keys in the scene:");
            self.settings.lines().for_each(|line| report.words(format!("    {line}")));
        }
        report.fmt(f)
    }
}
