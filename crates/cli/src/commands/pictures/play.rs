//! `flexframe play`.

use clap::Args;
use diagnostic::Failure;
use flexframe::html_report;
use flexframe::run::{self, RunSettings};
use whole_file::TemporaryFolder;

use crate::output;
use crate::scene_input::SceneInput;
use crate::served::Served;
use crate::session::Session;

/// Run a scene and show its live page at an address of this machine alone, until it is stopped (Ctrl-C).
#[derive(Debug, Args)]
pub struct Play {
    #[command(flatten)]
    scene: SceneInput,
    /// The port; 0 takes one that is free.
    #[arg(long, value_name = "N", default_value_t = 0)]
    port: u16,
}

impl Play {
    pub fn execute(self, mut session: Session) -> Result<(), Failure> {
        let Self { scene, port } = self;
        let scene = session.read_scene(scene)?;
        let served = Served::new(port)?;
        let folder = TemporaryFolder::new()?;
        let settings = RunSettings { check: false, ..session.settings(true) };
        let (_, report) = run::run(&scene, folder.path(), &settings, |p| {
            session.signals.heard(p);
            session.bar.run(p);
        })?;
        let contents = html_report::live_contents(&report.results, &session.builder, |p| session.bar.build(p))?;
        let page = html_report::page(&contents)?;
        // The page has all that it shows: nothing is left on the disk while it is there.
        drop((session.bar, contents, report, folder));
        output::line(&format!("  page     {} (Ctrl-C ends it)", served.address()))?;
        served.serve(page, &session.signals.stop())
    }
}
