//! `flexframe paper`: the paper's plate, each figure and number beside the paper's.

mod comparison;
mod figures;
mod page;
mod rigid_plate;

use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Instant;

use diagnostic::{Failure, Kind};
use results::Results;
use scene::Body;
use serde::Serialize;
use whole_file::write_whole;

use crate::commands::run::{RunProgress, RunReport, RunSettings, run};
use crate::files::json;
use crate::files::write_error::WriteError;
use crate::rows::columns::COLUMNS;
use comparison::Comparison;
use rigid_plate::WATCHED_POINT;

/// Report of `flexframe paper`.
#[derive(Debug, Clone, Serialize)]
pub struct PaperReport {
    /// The run itself.
    #[serde(flatten)]
    pub run: RunReport,
    /// The page.
    #[serde(serialize_with = "json::path")]
    pub report: PathBuf,
    /// The figures: SVG, PDF and PNG of each.
    #[serde(serialize_with = "json::paths")]
    pub figures: Vec<PathBuf>,
    /// The numbers on the page.
    pub comparison: Comparison,
}

/// The page, beside the figures.
const PAGE: &str = "report.md";

/// The files that [`reproduce`] writes to a folder beside the results file.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let figures = figures::NAMES.iter().flat_map(|name| ::figures::files(&folder.join(name)));
    std::iter::once(folder.join(PAGE)).chain(figures).collect()
}

/// Runs the scene of the paper's plate, draws every figure of the paper that can be made, and writes `report.md`
/// beside them.
///
/// # Errors
/// [`Failure`].
pub fn reproduce(
    body: &Body,
    folder: &Path,
    settings: &RunSettings,
    progress: impl FnMut(RunProgress),
) -> Result<PaperReport, Failure> {
    let only_plates = || {
        let words = "the paper has a free body with a mesh under dead half-sine forces";
        Kind::Input.of(&body.path).help("use `flexframe run` for others").says(words)
    };
    if !body.source.bends_far() {
        return Err(only_plates());
    }
    if !body.output.points.contains_key(WATCHED_POINT) {
        let help = "add it under [output.points], as in examples/plate.toml";
        let words = format!("the paper's figures need the output point {WATCHED_POINT}");
        return Err(Kind::Input.of(&body.path).help(help).says(words));
    }
    let (models, mut run) = run(&body.clone().into(), folder, settings, progress)?;
    let ([model], [of_plate]) = (&models[..], &run.bodies[..]) else { return Err(only_plates()) };
    let started = Instant::now();
    let results = Results::open(&run.results, &COLUMNS)?;
    let meshed = model.meshed.as_ref().ok_or_else(only_plates)?;
    let rigid = rigid_plate::histories(model, &results)?.ok_or_else(only_plates)?;
    let elements = meshed.elements.as_ref().ok_or_else(only_plates)?;
    let lumped = fem_tet10::centroid_lumped_inertia(&meshed.mesh, &elements.materials, &elements.point_masses)
        .map_err(model::BuildError::from)?;
    let comparison = Comparison::new(of_plate, &results, &rigid, &lumped);
    let figures = figures::draw(body, model, &results, &rigid, folder)?;
    run.times.add("figures", started.elapsed());
    let path = folder.join(PAGE);
    write_whole(&path, page::page(body, &run, &comparison)).map_err(WriteError::of(&path))?;
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
        write!(f, "  report   {} with {} figures beside it", self.report.display(), self.figures.len() / 3)
    }
}
