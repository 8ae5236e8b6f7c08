//! The lines of a trust card and their order.

use std::fmt;

use results::Metadata;
pub use results::TrustLine;
use serde::Serialize;

use crate::report::rounded;

/// An error below this calls for nothing.
pub(super) const SMALL: f64 = 1e-3;
/// Errors below this stand under what is not known.
const NOTED: f64 = 1e-2;
/// Digits of an error: all else is noise, which equal files must not have.
const DIGITS: usize = 3;

/// Limits of every card, in words.
const UNSEEN: &str = "Not seen: the phase of many vibrations, the inertia of what the modes leave out, and whether materials, loads and \
                      supports are those of the real part.";

/// A place where the answer of a run may be wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// The elements may not follow the stress.
    Mesh,
    /// The shapes may not follow the loads.
    Modes,
    /// The motion may not be resolved in time.
    Steps,
    /// The equations may not hold: the body bends further than they do.
    Model,
}

impl Place {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Mesh, Self::Modes, Self::Steps, Self::Model];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mesh => "mesh",
            Self::Modes => "modes",
            Self::Steps => "steps",
            Self::Model => "model",
        }
    }

    /// A line with an error. One that is not finite is not known.
    pub(super) fn known(self, error: f64, meaning: String, known: String, next: String) -> Line {
        let error = error.is_finite().then(|| rounded(error, DIGITS));
        Line(TrustLine { place: self.name().to_owned(), body: None, error, meaning, known, next })
    }

    /// A line without one: why, and what would tell.
    pub(super) fn not_known(self, why: &str, next: String) -> Line {
        let (place, meaning) = (self.name().to_owned(), format!("not known: {why}"));
        Line(TrustLine { place, body: None, error: None, meaning, known: String::new(), next })
    }
}

/// A line that has not got its body yet.
pub(super) struct Line(TrustLine);

impl Line {
    /// The line of a body.
    pub fn of(self, body: Option<String>) -> TrustLine {
        TrustLine { body, ..self.0 }
    }
}

/// The card of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TrustCard {
    /// A line for each place, the worst first.
    pub lines: Vec<TrustLine>,
    /// Limits of the card.
    pub unseen: &'static str,
    /// The lines of all bodies; none of a card that was read.
    #[serde(skip)]
    pub of_bodies: Vec<TrustLine>,
}

impl TrustCard {
    pub(super) fn new(lines: Vec<TrustLine>) -> Self {
        Self { lines, unseen: UNSEEN, of_bodies: Vec::new() }
    }

    /// The card in a results file, whose name is for the commands in it. Where it has none, nothing is known.
    pub fn of_file(metadata: &Metadata, file: &str) -> Self {
        if !metadata.trust.is_empty() {
            return Self::new(metadata.trust.clone());
        }
        let (why, next) = ("the file has no card: its run has not come to its end, or is of an older version", file);
        let line = |place: Place| place.not_known(why, format!("`flexframe check {next}`")).of(None);
        Self::new(Place::ALL.map(line).to_vec())
    }
}

/// The worst line of each place, the worst first; what is not known stands above what is known to be below a per cent. Of equal
/// ones the first.
pub(super) fn worst(lines: Vec<TrustLine>) -> Vec<TrustLine> {
    let mut worst: Vec<TrustLine> = Vec::with_capacity(Place::ALL.len());
    for line in lines {
        match worst.iter_mut().find(|other| other.place == line.place) {
            Some(other) if rank(&line) > rank(other) => *other = line,
            Some(_) => {}
            None => worst.push(line),
        }
    }
    worst.sort_by(|a, b| rank(b).total_cmp(&rank(a)));
    worst
}

fn rank(line: &TrustLine) -> f64 {
    line.error.unwrap_or(NOTED)
}

/// "0.21 %", "0.003 %"; with a power of ten where that has too many zeros.
pub(crate) fn percent(part: f64) -> String {
    let percent = 100.0 * part;
    match percent {
        0.0 => "0 %".to_owned(),
        10.0.. => format!("{percent:.0} %"),
        0.01.. => format!("{percent:.2} %"),
        1e-5.. => format!("{percent:.*} %", -percent.log10().floor() as usize),
        _ => format!("{percent:.0e} %"),
    }
}

impl fmt::Display for TrustCard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, line) in self.lines.iter().enumerate() {
            let head = if i == 0 { "trust" } else { "" };
            let body = line.body.as_ref().map_or_else(String::new, |body| format!("body {body}: "));
            write!(f, "  {head:<8} {:<6} {body}{}", line.place, line.meaning)?;
            for (before, text) in [("; ", &line.known), ("; to do: ", &line.next)] {
                if !text.is_empty() {
                    write!(f, "{before}{text}")?;
                }
            }
            writeln!(f)?;
        }
        write!(f, "           {}", self.unseen)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(place: Place, error: Option<f64>, body: &str) -> TrustLine {
        let line = match error {
            Some(error) => place.known(error, "off".to_owned(), "measured".to_owned(), String::new()),
            None => place.not_known("it was not asked for", "`flexframe check run.h5`".to_owned()),
        };
        line.of(Some(body.to_owned()))
    }

    #[test]
    fn the_worst_body_of_each_place_stands_and_what_is_not_known_is_above_small_errors() {
        let lines = vec![
            line(Place::Mesh, Some(0.002), "a"),
            line(Place::Modes, Some(0.2), "a"),
            line(Place::Model, None, "a"),
            line(Place::Steps, Some(1e-6), "a"),
            line(Place::Mesh, Some(0.03), "b"),
            line(Place::Modes, Some(0.1), "b"),
            line(Place::Model, Some(5e-3), "b"),
        ];
        let worst = worst(lines);
        let told: Vec<_> = worst.iter().map(|line| (line.place.as_str(), line.body.as_deref().unwrap())).collect();
        assert_eq!(told, [("modes", "a"), ("mesh", "b"), ("model", "a"), ("steps", "a")]);
        let text = TrustCard::new(worst).to_string();
        assert!(
            text.contains("model  body a: not known: it was not asked for; to do: `flexframe check run.h5`"),
            "{text}"
        );
        assert!(text.contains("Not seen: "), "{text}");
    }

    /// Closed form: three digits; what is not finite is not known.
    #[test]
    fn errors_have_three_digits_and_infinite_ones_are_not_known() {
        let error = |error: f64| Place::Steps.known(error, String::new(), String::new(), String::new()).of(None).error;
        assert_eq!(error(0.012_345_6), Some(0.0123));
        assert_eq!(error(0.0), Some(0.0));
        assert_eq!([error(f64::INFINITY), error(f64::NAN)], [None, None]);
        let told = [0.0, 3e-9, 3.4e-7, 2e-5, 0.002_13, 0.25].map(percent);
        assert_eq!(told, ["0 %", "3e-7 %", "0.00003 %", "0.002 %", "0.21 %", "25 %"]);
    }
}
