//! `flexframe paper`: the paper's plate, each figure and number beside the paper's.

mod comparison;
mod figures;
mod page;
mod rigid_plate;

use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Instant;

use results::{FileError, Results};
use rigid_kin::{RigidBodyError, StepError};
use scene::{BuildError, Scene};
use serde::Serialize;
use whole_file::write_whole;

use crate::columns::COLUMNS;
use crate::json;
use crate::mode_shapes::ShapesError;
use crate::run::{RunError, RunProgress, RunReport, RunSettings, run};
use comparison::Comparison;

/// The point whose accelerations Figs. 10 to 13 show.
const WATCHED_POINT: &str = "P1";

/// A reproduction that could not be made.
#[derive(Debug, thiserror::Error)]
pub enum PaperError {
    /// The scene could not be run.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The lumped inertia could not be found.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The results could not be read back.
    #[error(transparent)]
    File(#[from] FileError),
    /// A figure could not be drawn.
    #[error(transparent)]
    Figure(#[from] ShapesError),
    /// The rigid plate has no mass or inertia.
    #[error(transparent)]
    RigidBody(#[from] RigidBodyError),
    /// The rigid plate could not be stepped.
    #[error(transparent)]
    Step(#[from] StepError),
    /// The scene lacks a point that the paper's figures need.
    #[error("{scene}: the paper's figures need the output point {point}; add it under [output.points], as in examples/plate.toml", scene = scene.display())]
    MissingPoint {
        /// The scene file.
        scene: PathBuf,
        /// The point.
        point: &'static str,
    },
    /// Another body, or other loads, than the paper's.
    #[error("{}: the paper has a free body with a mesh under dead half-sine forces; use `flexframe run` for others", scene.display())]
    NotThePlate {
        /// The scene file.
        scene: PathBuf,
    },
    /// The report cannot be written.
    #[error("{}: cannot write the report: {source}", path.display())]
    Report {
        /// The report.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
}

/// What `flexframe paper` says at its end.
#[derive(Debug, Clone, Serialize)]
pub struct PaperReport {
    /// The run itself.
    #[serde(flatten)]
    pub run: RunReport,
    /// The page.
    #[serde(serialize_with = "json::path")]
    pub report: PathBuf,
    /// The figures, SVG and PNG.
    #[serde(serialize_with = "json::paths")]
    pub figures: Vec<PathBuf>,
    /// The numbers on the page.
    pub comparison: Comparison,
}

/// Runs the scene of the paper's plate, draws every figure of the paper that can be made, and writes `report.md`
/// beside them.
///
/// # Errors
/// [`PaperError`].
pub fn reproduce(
    scene: &Scene,
    folder: &Path,
    settings: &RunSettings,
    progress: impl FnMut(RunProgress),
) -> Result<PaperReport, PaperError> {
    if !scene.output.points.contains_key(WATCHED_POINT) {
        return Err(PaperError::MissingPoint { scene: scene.path.clone(), point: WATCHED_POINT });
    }
    let (model, mut run) = run(scene, folder, settings, progress)?;
    let started = Instant::now();
    let results = Results::open(&run.results, &COLUMNS)?;
    let only_plates = || PaperError::NotThePlate { scene: scene.path.clone() };
    let meshed = model.meshed.as_ref().ok_or_else(only_plates)?;
    let rigid = rigid_plate::histories(&model, &results)?.ok_or_else(only_plates)?;
    let lumped = scene.centroid_lumped_inertia(&meshed.mesh)?.ok_or_else(only_plates)?;
    let comparison = Comparison::new(&run, &results, &rigid, &lumped);
    let figures = figures::draw(scene, &model, &results, &rigid, folder)?;
    run.times.add("figures", started.elapsed());
    let path = folder.join("report.md");
    write_whole(&path, page::page(scene, &run, &comparison))
        .map_err(|source| PaperError::Report { path: path.clone(), source })?;
    Ok(PaperReport { run, report: path, figures, comparison })
}

impl fmt::Display for PaperReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { run, comparison, .. } = self;
        writeln!(f, "{run}")?;
        writeln!(
            f,
            "  paper    frequencies within {:.2} % of Table 1; rigid motion within {:.1e} of the rigid plate's peak",
            100.0 * comparison.worst_frequency_difference(),
            comparison.worst_rigid_difference()
        )?;
        write!(f, "  report   {} with {} figures beside it", self.report.display(), self.figures.len() / 2)
    }
}
