//! `flexframe frf`.

use std::path::PathBuf;

use clap::Args;
use diagnostic::Failure;
use flexframe::frequencies::Frequencies;
use flexframe::frf::{self, FrfSettings};
use flexframe::outputs::outputs_of_system;

use crate::arguments::values::{frequencies, positive};
use crate::arguments::{FileArgs, LinearArgs, SceneArgs};
use crate::output;
use crate::session::{Session, folder};

/// Compute frequency responses of points and joints to loads: table, CSV and chart.
///
/// Inputs and outputs are those of `flexframe linearize`. Static shapes of the loads, where the model has them, are the
/// residual flexibility of the modes that are left out.
#[derive(Debug, Args)]
pub struct Frf {
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    about: LinearArgs,
    /// Frequencies in cycles per time: from start to end, both included, count in all.
    #[arg(long, value_name = "START:END:COUNT", value_parser = frequencies)]
    frequencies: Frequencies,
    /// Space the frequencies by equal ratios.
    #[arg(long)]
    log: bool,
    /// Loss factor of structural damping, in the place of the scene's damping.
    #[arg(long, value_name = "FACTOR", value_parser = positive)]
    structural: Option<f64>,
    /// Folder for frf.csv, the chart and the page [default: out/<name of the scene file>].
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    #[command(flatten)]
    files: FileArgs,
}

impl Frf {
    pub fn execute(self, mut session: Session) -> Result<(), Failure> {
        let Self { scene: SceneArgs { scene, json }, about, frequencies, log, structural, output, files } = self;
        output::require_file("--output", output.as_deref())?;
        let system = session.read_system(scene)?;
        let folder = folder(&system, output)?;
        outputs_of_system(&system, &session.builder, files.overwrite).claim(&frf::files(&folder))?;
        let settings = FrfSettings { linear: about.settings(), frequencies, logarithmic: log, loss_factor: structural };
        let report = frf::frf(&system, &session.builder, &folder, &settings, |p| session.bar.build(p))?;
        drop(session.bar);
        output::print(&report, json)
    }
}
