//! `flexframe run`.

use std::path::PathBuf;

use clap::Args;
use diagnostic::Failure;
use flexframe::accuracy;
use flexframe::run::RunSettings;

use crate::arguments::values;
use crate::arguments::{FileArgs, SceneArgs, folder};
use crate::output;
use crate::session::Session;
use crate::solver_input::SolverInput;

/// Run a scene and write its motion to an HDF5 file.
///
/// The first ctrl-C (or SIGTERM or SIGHUP) stops the run at its next row, and `flexframe resume` continues it. A second one, at
/// least half a second later, ends the program at once.
#[derive(Debug, Args)]
pub struct Run {
    #[command(flatten)]
    scene: SceneArgs,
    /// Folder for the results; it is made if it does not exist [default: out/<name of the scene file>].
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    #[command(flatten)]
    files: FileArgs,
    /// Allow a results file of more than 1 GB.
    #[arg(long)]
    large: bool,
    /// Leave out the check of a row by the full nonlinear body at the end (see `flexframe check`).
    #[arg(long)]
    no_check: bool,
    /// Find the settings for an answer with at most this error, such as 1% or 0.01, by the check; the scene may say it as `accuracy`.
    #[arg(long, value_name = "ERROR", value_parser = values::accuracy, conflicts_with = "no_check")]
    accuracy: Option<f64>,
    #[command(flatten)]
    solver: SolverInput,
}

impl Run {
    pub fn execute(self, mut session: Session) -> Result<(), Failure> {
        let Self { scene: SceneArgs { scene, json }, output, files, large, no_check, accuracy, solver } = self;
        output::require_file("--output", output.as_deref())?;
        let scene = session.read_scene(scene)?;
        if let Some(to) = solver.take_of(&scene.bodies, &mut session.builder, session.signals.slepc())? {
            return session.write_only(scene.only_body()?, &to, files.overwrite);
        }
        let folder = folder(&scene.path, output)?;
        let settings = RunSettings { large, check: !no_check, accuracy, ..session.settings(files.overwrite) };
        let (_, report) = accuracy::run(&scene, &folder, &settings, |p| {
            session.signals.heard(p);
            session.bar.run(p);
        })?;
        session.print(&report, json)
    }
}
