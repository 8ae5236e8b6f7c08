//! `flexframe paper`.

use std::path::PathBuf;

use clap::Args;
use diagnostic::Failure;
use flexframe::outputs::outputs_of_body;
use flexframe::paper;
use flexframe::run::RunSettings;

use crate::arguments::{FileArgs, SceneArgs, folder};
use crate::output;
use crate::session::Session;

/// Run the paper's plate and compare it with the paper: every figure, and a report.
#[derive(Debug, Args)]
pub struct Paper {
    #[command(flatten)]
    scene: SceneArgs,
    /// Folder for results, figures and report.md [default: out/<name of the scene file>].
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    #[command(flatten)]
    files: FileArgs,
}

impl Paper {
    pub fn execute(self, mut session: Session) -> Result<(), Failure> {
        let Self { scene: SceneArgs { scene, json }, output, files } = self;
        output::require_file("--output", output.as_deref())?;
        let scene = session.read(scene)?;
        let settings = RunSettings { check: true, ..session.settings(files.overwrite) };
        let folder = folder(&scene.path, output)?;
        outputs_of_body(&scene, &session.builder, files.overwrite).claim(&paper::files(&folder))?;
        let report = paper::reproduce(&scene, &folder, &settings, |p| {
            session.signals.heard(p);
            session.bar.run(p);
        })?;
        drop(session.bar);
        output::print(&report, json)
    }
}
