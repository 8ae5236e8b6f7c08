//! Report of `flexframe run`.

use std::fmt;
use std::path::PathBuf;

use scene::{Interpolation, Scene, TablePoints};
use serde::Serialize;

use super::accuracy_report::AccuracyReport;
use super::body_report::BodyRunReport;
use super::estimate::Estimate;
use super::large_choice::LargeChoice;
use super::tied_report::TiedReport;
use crate::commands::check::report::CheckReport;
use crate::files::json;
use crate::report::{Times, list_of_bodies};
use crate::rows::row::Row;
use crate::trust::card::TrustCard;

/// Report of `flexframe run`.
#[derive(Debug, Clone, Serialize)]
pub struct RunReport {
    /// Title of the scene.
    pub title: String,
    /// Labels of length, mass and time.
    pub units: [String; 3],
    /// The results file.
    #[serde(serialize_with = "json::path")]
    pub results: PathBuf,
    /// Tables of loads, motions and drives, and how they go from point to point.
    pub tables: Vec<TableInUse>,
    /// Rows in it.
    pub rows: u64,
    /// The estimate before it.
    pub estimate: Estimate,
    /// Formulation.
    pub formulation: String,
    /// Scheme.
    pub scheme: String,
    /// Tolerance, under step control.
    pub tolerance: Option<f64>,
    /// Steps per second of computing, writing included.
    #[serde(serialize_with = "json::number")]
    pub steps_per_second: f64,
    /// Each body, in the order of the scene. As JSON, what is told of a single one stands beside the list, too.
    #[serde(flatten, serialize_with = "list_of_bodies")]
    pub bodies: Vec<BodyRunReport>,
    /// Bodies that joints, springs or bushings tie together, and their joints.
    pub tied: Vec<TiedReport>,
    /// Steps of all motions.
    pub steps: u64,
    /// All bodies together, at the end.
    pub system: SystemReport,
    /// The row of each body where its model is most likely to be wrong, against the full body; `None` where that was not asked for, would cost
    /// more than the body did, or could not be done.
    pub check: Option<CheckReport>,
    /// Large modes that the check has found better: those of this run where `large_is_chosen`, else those that it ought to have.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub large_choice: Option<LargeChoice>,
    /// True if the run was made once more, with the large modes that the check of the first found better.
    pub large_is_chosen: bool,
    /// The accuracy that was asked for, and the settings that were found for it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub accuracy: Option<AccuracyReport>,
    /// The trust card; `None` where the results are only rows.
    pub trust: Option<TrustCard>,
    /// Assumptions that did not hold, with the name of the body where there are several.
    pub warnings: Vec<String>,
    /// Where the time went, seconds.
    pub times: Times,
}

/// A table of a history.
#[derive(Debug, Clone, Serialize)]
pub struct TableInUse {
    /// Its file; `None` if it stands in the scene.
    #[serde(serialize_with = "json::optional_path")]
    pub file: Option<PathBuf>,
    /// The number of its points.
    pub points: usize,
    /// The way from point to point.
    pub interpolation: Interpolation,
}

impl TableInUse {
    /// The tables of a scene.
    pub(super) fn all(scene: &Scene) -> Vec<Self> {
        let of = |table: &TablePoints| Self {
            file: table.file.clone(),
            points: table.points.len(),
            interpolation: table.interpolation,
        };
        scene.tables().map(of).collect()
    }
}

impl fmt::Display for TableInUse {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.file {
            Some(file) => write!(f, "{}, {} points", file.display(), self.points)?,
            None => write!(f, "{} points of the scene", self.points)?,
        }
        write!(f, ": {}", self.interpolation.words())
    }
}

/// All bodies together in the last row.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct SystemReport {
    /// Kinetic plus strain energy.
    #[serde(serialize_with = "json::number")]
    pub final_energy: f64,
    /// Work of the loads since the beginning.
    #[serde(serialize_with = "json::number")]
    pub work: f64,
    /// Linear momentum, global.
    #[serde(serialize_with = "json::numbers")]
    pub linear_momentum: [f64; 3],
    /// Angular momentum about the global origin, global.
    #[serde(serialize_with = "json::numbers")]
    pub angular_momentum: [f64; 3],
}

impl SystemReport {
    pub(super) fn of(last: &Row) -> Self {
        Self {
            final_energy: last.energy(),
            work: last.work(),
            linear_momentum: last.linear_momentum_global().into(),
            angular_momentum: last.angular_momentum_global().into(),
        }
    }
}
