//! `flexframe report`.

use std::path::PathBuf;

use clap::Args;
use diagnostic::Failure;
use flexframe::given_file::GivenFile;
use flexframe::html_report;
use flexframe::outputs::{Written, outputs_of_results};

use crate::arguments::FileArgs;
use crate::output;
use crate::session::{RESULTS, Session};

/// Write one HTML page about a run: the moving body in 3-D, shapes, histories, balances. It needs no network.
#[derive(Debug, Args)]
pub struct Report {
    /// The results file; an unfinished one is shown up to its last row, and marked.
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// The page to write, or - for standard output [default: the results file's name with .html].
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Put the run itself into the page: it computes the motion, lets it be changed, and be pulled at with the pointer.
    /// The bodies are built again from the scene in the file, with their meshes.
    #[arg(long)]
    live: bool,
    /// Show another run beside it: its bodies as ghosts, its courses, and their differences.
    #[arg(long, value_name = "FILE", conflicts_with = "live")]
    compare: Option<PathBuf>,
    #[command(flatten)]
    files: FileArgs,
}

impl Report {
    pub fn execute(self, mut session: Session) -> Result<(), Failure> {
        let Self { file, output, live, compare, files } = self;
        for file in [&file].into_iter().chain(&compare) {
            GivenFile::expect(file, &[GivenFile::Results], RESULTS)?;
        }
        let mut contents = || match &compare {
            Some(other) => html_report::compared_contents(&file, other),
            None if live => html_report::live_contents(&file, &session.builder, |p| session.bar.build(p)),
            None => html_report::contents(&file),
        };
        if output.as_deref().is_some_and(output::is_standard) {
            let page = html_report::page(&contents()?)?;
            drop(session.bar);
            return output::text(&page);
        }
        let output = output.unwrap_or_else(|| file.with_extension("html"));
        let mut outputs = outputs_of_results(&file, files.overwrite);
        if let Some(other) = &compare {
            outputs = outputs.and_input(other);
        }
        outputs.claim_as(&Written::PAGE, &output)?;
        html_report::write(&contents()?, &output)?;
        drop(session.bar);
        output::list(&[output])
    }
}
