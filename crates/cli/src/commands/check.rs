//! `flexframe check`.

use std::path::PathBuf;

use clap::Args;
use diagnostic::Failure;
use flexframe::check::{self, CheckRows};
use flexframe::given_file::GivenFile;

use crate::output;
use crate::session::{RESULTS, Session};

/// Check rows of a run against the full nonlinear body of its mesh: how wrong the displacements and the frequencies are, and why.
#[derive(Debug, Args)]
pub struct Check {
    /// The results file, such as out/plate/plate.h5, or the unfinished one of a run. Its meshes have to be where they were.
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Numbers of the rows, from 0 [default: those where a model is most likely to be wrong].
    #[arg(long, value_name = "N,…", value_delimiter = ',')]
    rows: Vec<usize>,
    /// Write the trust card with what the check finds into the results file, so that `flexframe report` shows it.
    #[arg(long)]
    write: bool,
    /// Print the report as JSON, for scripts, and errors as JSON on standard error.
    #[arg(long)]
    json: bool,
}

impl Check {
    pub fn execute(self, mut session: Session) -> Result<(), Failure> {
        let Self { file, rows, write, json } = self;
        GivenFile::expect(&file, &[GivenFile::Results], RESULTS)?;
        if write {
            check::expect_finished(&file)?;
        }
        let rows = if rows.is_empty() { CheckRows::Worst } else { CheckRows::Given(rows) };
        let report = check::check(&file, &session.builder, &rows, |p| session.bar.check(p))?;
        drop(session.bar);
        output::print(&report, json)?;
        if write { Ok(check::write_card(&report)?) } else { Ok(()) }
    }
}
