//! The cheapest setting that reaches a target.

use std::fmt;

use scene::Rows;
use serde::Serialize;

use super::body::CostBody;
use super::case::PreparedScene;
use super::ladder::{Evaluator, LadderRun, Line, Outcome, settings_between};
use super::setting::Setting;
use super::short::{duration, setting};
use crate::files::json;

/// A setting between two others cannot be faster than the finer of them by more than this.
const MAX_GAIN: f64 = 2.7;

/// The cheapest way to a target.
#[derive(Debug, Clone, Serialize)]
pub struct Answer {
    /// The error asked for.
    pub target: f64,
    /// Lines for the section `[time]` of the scene; none where nothing reaches the target.
    pub lines: Vec<String>,
    /// The run; none where nothing reaches the target.
    pub run: Option<LadderRun>,
    /// The smallest error that is known of.
    #[serde(serialize_with = "json::number")]
    pub smallest_error: f64,
    /// True if the scene's `every` has to give way to an `interval`.
    pub needs_interval: bool,
    /// Change by the modes left out, if that is more than the target.
    pub modes: Option<String>,
    /// The settings whose runs were stopped because they take longer than the patience, and how far they came.
    pub out_of_patience: Vec<String>,
}

/// Looks between the settings for cheaper ones that still reach the target, and adds them to the lines.
pub(super) fn refine(case: &PreparedScene<'_>, evaluator: &Evaluator<'_>, lines: &mut [Line], target: f64) {
    let fastest = lines.iter().filter_map(|line| Some(first_reaching(line, target)?.1)).fold(f64::INFINITY, f64::min);
    for line in lines {
        let Some((reaches, seconds)) = first_reaching(line, target) else { continue };
        if reaches == 0 || seconds > MAX_GAIN * fastest {
            continue;
        }
        let (coarse, fine) = (line.rows[reaches - 1].setting, line.rows[reaches].setting);
        let mut between = settings_between(case, coarse, fine);
        while !between.is_empty() {
            let finer = between.split_off(between.len() / 2);
            let control = finer[0];
            let row = LadderRun::new(control, evaluator.measure(case, line.method, control), false);
            let good = row.measured().is_some_and(|measured| measured.error <= target);
            line.insert(row);
            if !good {
                between = finer[1..].to_vec();
            }
        }
    }
}

/// The longest step of a line that reaches the target, and its time.
fn first_reaching(line: &Line, target: f64) -> Option<(usize, f64)> {
    line.rows
        .iter()
        .enumerate()
        .find_map(|(i, row)| row.measured().filter(|m| m.error <= target).map(|m| (i, m.seconds)))
}

impl Answer {
    pub(super) fn new(target: f64, rows: Rows, lines: &[Line], bodies: &[CostBody]) -> Self {
        let runs =
            || lines.iter().flat_map(|line| line.rows.iter().filter_map(move |row| Some((line, row, row.measured()?))));
        let best = runs()
            .filter(|(_, _, measured)| measured.error <= target)
            .min_by(|a, b| a.2.seconds.total_cmp(&b.2.seconds))
            .map(|(line, row, _)| (line, row));
        let time_lines = |line: &Line, row: &LadderRun| {
            let formulation = format!("formulation = \"{}\"", line.formulation);
            // Tied bodies have but one.
            let formulation = line.method.joints.is_none().then_some(formulation);
            let others = [format!("scheme = \"{}\"", line.scheme), row.setting.to_string()];
            formulation.into_iter().chain(others).collect()
        };
        Self {
            target,
            lines: best.map_or_else(Vec::new, |(line, row)| time_lines(line, row)),
            run: best.map(|(_, row)| row.clone()),
            smallest_error: runs().map(|(_, _, measured)| measured.error).fold(f64::INFINITY, f64::min),
            needs_interval: matches!(rows, Rows::EverySteps(_))
                && best.is_some_and(|(_, row)| matches!(row.setting, Setting::Tolerance(_))),
            modes: CostBody::modes_warning(bodies, target),
            out_of_patience: out_of_patience(lines),
        }
    }
}

/// The runs that the patience has stopped, in words.
pub(super) fn out_of_patience(lines: &[Line]) -> Vec<String> {
    let words = |line: &Line, row: &LadderRun| {
        let Outcome::OutOfPatience(stopped) = &row.outcome else { return None };
        let own = if row.of_scene { " (the scene's own setting)" } else { "" };
        Some(format!("{}, {}{own}: {stopped}", line.name(), setting(row.setting)))
    };
    lines.iter().flat_map(|line| line.rows.iter().filter_map(move |row| words(line, row))).collect()
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.run.as_ref().and_then(LadderRun::measured) {
            Some(run) => {
                write!(
                    f,
                    "{} is within {:.1e} of the reference (target {:e}): {} steps, {} evaluations, {}",
                    self.lines.join(", "),
                    run.error,
                    self.target,
                    run.steps,
                    run.evaluations,
                    duration(run.seconds)
                )?;
                write!(f, "\n\n  [time]")?;
                for line in &self.lines {
                    write!(f, "\n  {line}")?;
                }
                if self.needs_interval {
                    write!(f, "\n\nwith `interval` instead of `every` under [output]")?;
                }
            }
            None => write!(
                f,
                "no setting that was tried is known to be within {:e} of the reference; the closest is within {:.1e} \
                 (more time for shorter steps and a finer reference: --patience)",
                self.target, self.smallest_error
            )?,
        }
        if let Some(modes) = &self.modes {
            write!(f, "\n\n{modes}")?;
        }
        if !self.out_of_patience.is_empty() {
            write!(f, "\n\nThese runs took too long and were stopped, so their error and time are not known:")?;
            self.out_of_patience.iter().try_for_each(|run| write!(f, "\n  {run}"))?;
        }
        Ok(())
    }
}
