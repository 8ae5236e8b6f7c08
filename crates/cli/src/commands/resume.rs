//! `flexframe resume`.

use std::path::PathBuf;

use clap::Args;
use diagnostic::Failure;
use flexframe::given_file::GivenFile;
use flexframe::run::{self, RunSettings};

use crate::arguments::FileArgs;
use crate::output;
use crate::session::Session;

/// Continue an interrupted run: the results are the same, bit for bit, as those of a run without interruption.
#[derive(Debug, Args)]
pub struct Resume {
    /// The unfinished file, such as out/plate/plate.part.h5, or the name of its results file.
    #[arg(value_name = "FILE")]
    file: PathBuf,
    #[command(flatten)]
    files: FileArgs,
    /// Leave out the check by the full nonlinear body at the end, as `flexframe run --no-check` does.
    #[arg(long)]
    no_check: bool,
    /// Print the summary as JSON, for scripts, and errors as JSON on standard error.
    #[arg(long)]
    json: bool,
}

impl Resume {
    pub fn execute(self, mut session: Session) -> Result<(), Failure> {
        let Self { file, files, no_check, json } = self;
        GivenFile::expect(&file, &[GivenFile::Results], "the unfinished results file of a run")?;
        let settings = RunSettings { check: !no_check, ..session.settings(files.overwrite) };
        let report = run::resume(&file, &settings, |p| {
            session.signals.heard(p);
            session.bar.run(p);
        })?;
        drop(session.bar);
        output::print(&report, json)
    }
}
