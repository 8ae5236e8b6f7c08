//! Report of a price list.

use std::path::PathBuf;

use serde::Serialize;

use super::answer::Answer;
use super::ladder::Line;
use super::machine::Machine;
use super::modes::ModesRow;
use super::reference::ReferenceReport;
use crate::files::json;

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
    /// Flexible modes kept.
    pub flexible: usize,
    /// Their highest frequency, cycles per time; none for a rigid body.
    pub highest_frequency: Option<f64>,
    /// |ω| at the beginning.
    pub initial_spin: f64,
    /// End of the run.
    pub end: f64,
    /// Points whose velocity and acceleration are compared.
    pub points: usize,
    /// The reference of all errors.
    pub reference: ReferenceReport,
    /// The limit of the paper's formulation for short steps; its errors are those to the reference.
    pub paper_limit: Option<ReferenceReport>,
    /// Reason of its absence.
    pub paper_limit_failure: Option<String>,
    /// The ladders.
    pub lines: Vec<Line>,
    /// The same motion with fewer and with more modes, fewest first; empty where they could not be compared.
    pub modes: Vec<ModesRow>,
    /// Reason of the missing comparison.
    pub modes_failure: Option<String>,
    /// The answer to the target.
    pub answer: Option<Answer>,
    /// Files written.
    #[serde(serialize_with = "json::paths")]
    pub files: Vec<PathBuf>,
}
