//! Report of `flexframe check`.

use std::fmt;
use std::path::PathBuf;

use model::{BodyStressCheck, CheckedStress, Mend, StateCheck};
use nalgebra::Vector3;
use serde::Serialize;

use crate::commands::modes::frequency_unit;
use crate::files::json;
use crate::rows::units::UnitLabels;
use crate::trust::card::TrustCard;

/// Report of `flexframe check`.
#[derive(Debug, Clone, Serialize)]
pub struct CheckReport {
    /// Title of the scene.
    pub title: String,
    /// Labels of length, mass and time.
    pub units: [String; 3],
    /// The results file.
    #[serde(serialize_with = "json::path")]
    pub results: PathBuf,
    /// Each body, in the order of the scene.
    pub bodies: Vec<BodyCheck>,
    /// The trust card of the file with what the check has found; `None` at the end of a run, which makes its own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub trust: Option<TrustCard>,
}

/// The check of a body.
#[derive(Debug, Clone, Serialize)]
pub struct BodyCheck {
    /// Its name.
    pub name: String,
    /// The rows.
    pub rows: Vec<RowCheck>,
    /// The reason that it was not checked.
    pub not_checked: Option<String>,
}

/// The check of a row.
#[derive(Debug, Clone, Serialize)]
pub struct RowCheck {
    /// Its number, from 0.
    pub row: usize,
    /// The reasons that it was chosen.
    pub why: Vec<&'static str>,
    /// The state against the full body.
    #[serde(flatten)]
    pub state: StateCheck,
}

impl BodyCheck {
    /// The row with the largest error, against the largest displacements of the run.
    pub fn worst(&self) -> Option<&RowCheck> {
        self.rows.iter().max_by(|a, b| a.state.error_of_largest.total_cmp(&b.state.error_of_largest))
    }
}

/// The reason that a rigid body is not checked.
pub(super) const RIGID: &str = "it is rigid";

/// The reason that a body is not checked at the end of a run.
pub(crate) const DEAR: &str = "its full body costs more than its reduction did; `flexframe check` does it on demand";

/// A row whose displacements are below this part of the largest of the run is stated against those.
const QUIET: f64 = 0.5;

/// The limit of the check, in words.
const UNSEEN: &str = "not seen by it: phase, and the inertia of what the model leaves out";

impl fmt::Display for CheckReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.title)?;
        for body in &self.bodies {
            if self.bodies.len() > 1 {
                write!(f, "\nbody {}", body.name)?;
            }
            if let Some(why) = &body.not_checked {
                write!(f, "\n  not checked: {why}")?;
            }
            for row in &body.rows {
                row.write(f, &self.units)?;
            }
        }
        if self.bodies.iter().any(|body| !body.rows.is_empty()) {
            write!(f, "\n  {UNSEEN}")?;
        }
        self.trust.iter().try_for_each(|trust| write!(f, "\n{trust}"))
    }
}

impl CheckReport {
    /// The largest error of a row, against the largest displacements of the run.
    pub(crate) fn largest_error(&self) -> f64 {
        let worst = self.bodies.iter().filter_map(BodyCheck::worst);
        worst.map(|row| row.state.error_of_largest).fold(0.0, f64::max)
    }

    /// Adds further rows of the same bodies.
    pub(crate) fn add(&mut self, more: Self) {
        self.bodies.iter_mut().zip(more.bodies).for_each(|(body, more)| body.rows.extend(more.rows));
    }

    /// The name of a body before what is said of it, where there are several.
    fn head(&self, body: &BodyCheck) -> String {
        if self.bodies.len() > 1 { format!("body {}: ", body.name) } else { String::new() }
    }

    /// Each body that has lost its stability at a row, in words.
    pub(crate) fn instabilities(&self) -> Vec<String> {
        let of_body = |body: &BodyCheck| {
            let name = self.head(body);
            let time = &self.units[2];
            body.rows.iter().find_map(|row| {
                let words = row.stability_in_words()?;
                Some(format!("{name}at time {:.6} {time} {words}, by the full nonlinear body", row.state.time))
            })
        };
        self.bodies.iter().filter_map(of_body).collect()
    }

    /// The lines in the summary of a run.
    pub(crate) fn write_in_run(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for body in &self.bodies {
            let name = self.head(body);
            match (body.worst(), &body.not_checked) {
                (Some(row), _) => writeln!(f, "  check    {name}{}", row.in_words(&self.units))?,
                (None, Some(why)) if why != RIGID => writeln!(f, "  check    {name}none: {why}")?,
                (None, _) => {}
            }
        }
        Ok(())
    }
}

impl RowCheck {
    fn write(&self, f: &mut fmt::Formatter<'_>, units: &[String; 3]) -> fmt::Result {
        let [length, _, time] = units;
        let state = &self.state;
        write!(f, "\n  row {} (time {:.6} {time}: {})", self.row, state.time, self.why.join(", "))?;
        write!(f, "\n    {}", self.error_in_words(length))?;
        // Against what the whole is stated against.
        let scale = if state.error_of_largest > 0.0 { self.stated() / state.error_of_largest } else { 0.0 };
        for part in &state.parts {
            let mend = part.mend.map(|mend| format!(": mended by {}", mend.words())).unwrap_or_default();
            write!(f, "\n      {} {}{mend}", part.direction.words(), percent(scale * part.size))?;
        }
        if state.drift >= 1e-3 && state.drift > state.error_of_largest {
            write!(
                f,
                "\n      vibrations out by up to {} of the largest at the end, if it is so all the time",
                percent(state.drift)
            )?;
        }
        for point in &state.points {
            let [x, y, z] = point.displacement;
            let error = Vector3::from(point.error).norm();
            let (name, at) = (&point.name, format!("({x:.4e}, {y:.4e}, {z:.4e}) {length}"));
            match self.is_quiet() {
                true => write!(f, "\n    {name}: wrong by {error:.1e} of {at}")?,
                false => write!(f, "\n    {name}: {} of {at}", percent(point.relative))?,
            }
        }
        if let Some(stress) = &state.stress {
            let unit = UnitLabels { length, mass: &units[1], time }.stress();
            for CheckedStress { name, full, error } in &stress.points {
                write!(f, "\n    stress at {name}: wrong by {error:.1e} of {full:.4e} {unit}")?;
            }
            if let Some(body) = stress.body {
                let BodyStressCheck { full, error, max_error, .. } = body;
                write!(
                    f,
                    "\n    largest stress {full:.4e} {unit}: wrong by {error:.1e} there, and by {max_error:.1e} at most"
                )?;
            }
        }
        if !state.frequencies.is_empty() {
            let each = state.frequencies.iter().map(|f| format!("{:.4} ({:+.2} %)", f.full, 100.0 * f.error));
            let each: Vec<String> = each.collect();
            write!(f, "\n    frequencies {} {}", each.join(", "), frequency_unit(time))?;
        }
        if let Some(words) = self.stability_in_words() {
            write!(f, "\n    {words}")?;
        }
        Ok(())
    }

    /// The error as words state it.
    fn stated(&self) -> f64 {
        if self.is_quiet() { self.state.error_of_largest } else { self.state.error }
    }

    /// True if the body is hardly deformed, against what it is in the run.
    fn is_quiet(&self) -> bool {
        self.state.error_of_largest < QUIET * self.state.error
    }

    /// "displacements right to 0.3 % at time 1.2 (largest strain energy)".
    fn in_words(&self, units: &[String; 3]) -> String {
        let [length, _, time] = units;
        let why = self.why.join(", ");
        let mut words = format!("{} at time {:.6} {time} ({why})", self.error_in_words(length), self.state.time);
        if !self.state.mends.is_empty() {
            words = format!("{words}; mended by {}", mends_in_words(&self.state.mends));
        }
        words
    }

    fn error_in_words(&self, length: &str) -> String {
        let StateCheck { largest_error, largest_displacement, is_settled, .. } = self.state;
        let about = if is_settled { "" } else { "about " };
        let of = if self.is_quiet() { " of the largest in the run" } else { "" };
        format!(
            "displacements wrong by {about}{}{of} by the full nonlinear body (a node by up to {largest_error:.3e} of {largest_displacement:.3e} {length})",
            percent(self.stated())
        )
    }

    fn stability_in_words(&self) -> Option<String> {
        let StateCheck { negative_directions, growth, .. } = self.state;
        match (negative_directions.unwrap_or(0), growth) {
            (0, 0.0) => None,
            (0, _) => Some(format!("the true body is unstable: a vibration grows at {growth:.3e} per time")),
            (count, 0.0) => Some(format!(
                "the true body has lost its stiffness in {count} direction(s): it buckles, or its spin alone holds it"
            )),
            (count, _) => Some(format!(
                "the true body has lost its stiffness in {count} direction(s): it buckles, and a vibration grows at {growth:.3e} per time"
            )),
        }
    }
}

fn percent(part: f64) -> String {
    let percent = 100.0 * part;
    if percent != 0.0 && percent < 0.01 { format!("{percent:.0e} %") } else { format!("{percent:.2} %") }
}

fn mends_in_words(mends: &[Mend]) -> String {
    mends.iter().map(|mend| mend.words()).collect::<Vec<_>>().join(", or by ")
}
