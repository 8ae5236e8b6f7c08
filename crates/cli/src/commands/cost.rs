//! `flexframe cost`.

use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use diagnostic::Failure;
use flexframe::accuracy::{FILES, prices};
use flexframe::cost::{self, CostSettings};
use flexframe::outputs::outputs_of_scene;

use crate::arguments::values::{accuracy, patience, positive};
use crate::arguments::{FileArgs, SceneArgs, folder};
use crate::output;
use crate::session::Session;

/// Measure error and computing time on a scene, for every scheme at many steps.
#[derive(Debug, Args)]
pub struct Cost {
    #[command(flatten)]
    scene: SceneArgs,
    /// Folder for cost.csv and the diagram [default: out/<name of the scene file>].
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    #[command(flatten)]
    files: FileArgs,
    /// Find the cheapest setting within this error, ready for the scene.
    #[arg(long, value_name = "ERROR", value_parser = positive)]
    target: Option<f64>,
    /// Find the settings for each of these errors by `run --accuracy`, and list their times in the place of the schemes.
    #[arg(long, value_name = "ERROR,…", value_parser = accuracy, value_delimiter = ',', conflicts_with_all = ["target", "patience"])]
    accuracies: Vec<f64>,
    /// Longest time of a run in seconds; the reference may take twenty times as long.
    #[arg(long, value_name = "SECONDS", default_value = "1", value_parser = patience)]
    patience: Duration,
}

impl Cost {
    pub fn execute(self, mut session: Session) -> Result<(), Failure> {
        let Self { scene: SceneArgs { scene, json }, output, files, target, accuracies, patience } = self;
        output::require_file("--output", output.as_deref())?;
        let scene = session.read_scene(scene)?;
        let settings = CostSettings { target, ..CostSettings::with_patience(patience) };
        let folder = folder(&scene.path, output)?;
        let outputs = outputs_of_scene(&scene, &session.builder, files.overwrite);
        if !accuracies.is_empty() {
            return session.report(outputs, &folder, &FILES, json, |session| {
                Ok(prices(&scene, &accuracies, &session.builder, |p| session.bar.run(p))?)
            });
        }
        outputs.claim(&cost::files(&folder))?;
        let report = cost::price_list(&scene, &session.builder, &folder, settings, |p| session.bar.cost(p))?;
        drop(session.bar);
        output::print(&report, json)
    }
}
