//! Report of a price list.

use std::path::PathBuf;

use serde::Serialize;

use super::answer::Answer;
use super::ladder::Line;
use super::machine::Machine;
use super::modes::{ModesRow, modes_warning};
use super::reference::ReferenceReport;
use crate::files::json;
use crate::report::list_of_bodies;

/// The price list of a scene.
#[derive(Debug, Clone, Serialize)]
pub struct CostReport {
    /// Title of the scene.
    pub title: String,
    /// The scene file.
    #[serde(serialize_with = "json::path")]
    pub scene: PathBuf,
    /// Label of the unit of time.
    pub time_unit: String,
    /// Where it was measured.
    pub machine: Machine,
    /// End of the run.
    pub end: f64,
    /// Each body, in the order of the scene. As JSON, what is told of a single one stands beside the list, too.
    #[serde(flatten, serialize_with = "list_of_bodies")]
    pub bodies: Vec<CostBody>,
    /// The reference of all errors.
    pub reference: ReferenceReport,
    /// The limit of the paper's formulation for short steps; its errors are those to the reference.
    pub paper_limit: Option<ReferenceReport>,
    /// Reason of its absence.
    pub paper_limit_failure: Option<String>,
    /// The ladders.
    pub lines: Vec<Line>,
    /// The answer to the target.
    pub answer: Option<Answer>,
    /// Files written.
    #[serde(serialize_with = "json::paths")]
    pub files: Vec<PathBuf>,
}

/// A body of a price list.
#[derive(Debug, Clone, Serialize)]
pub struct CostBody {
    /// Its name.
    pub name: String,
    /// Flexible modes kept.
    pub flexible: usize,
    /// Their highest frequency, cycles per time; none for a rigid body.
    pub highest_frequency: Option<f64>,
    /// |ω| at the beginning.
    pub initial_spin: f64,
    /// Points whose velocity and acceleration are compared.
    pub points: usize,
    /// The same motion with fewer and with more modes, fewest first; empty where they could not be compared.
    pub modes: Vec<ModesRow>,
    /// Reason of the missing comparison.
    pub modes_failure: Option<String>,
}

impl CostBody {
    /// Says of which bodies more digits than a target's need more modes.
    pub(super) fn modes_warning(bodies: &[Self], target: f64) -> Option<String> {
        let of_body = |body: &Self| {
            let words = modes_warning(&body.modes, body.flexible, target)?;
            Some(if bodies.len() == 1 { words } else { format!("Body {}: {words}", body.name) })
        };
        let words: Vec<String> = bodies.iter().filter_map(of_body).collect();
        (!words.is_empty()).then(|| words.join("\n\n"))
    }
}
