//! Report of a price list.

mod table;

use std::path::PathBuf;

use serde::Serialize;

use super::answer::Answer;
use super::body::CostBody;
use super::ladder::Line;
use super::machine::Machine;
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
