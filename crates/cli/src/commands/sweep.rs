//! `flexframe sweep`.

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use diagnostic::Failure;
use flexframe::given_file::GivenFile;
use flexframe::sweep::{self, Shard, SweepSettings};

use crate::arguments::FileArgs;
use crate::output;
use crate::session::Session;

/// Run a scene with many values of its keys, and write a table of parameters and results (docs/reference/cli.md).
///
/// A row that fails is marked with its error, and the others go on. Run again, it does the rows that are not done.
#[derive(Debug, Args)]
pub struct Sweep {
    /// The file of the sweep: a scene, parameters and results.
    #[arg(value_name = "SWEEP")]
    sweep: PathBuf,
    /// The table to write [default: out/<name of the sweep file>.h5].
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Run a part of the rows only, such as 2/4: for several machines. Its table is <table>.2-of-4.h5.
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
    /// Merge the tables of N shards into one.
    #[arg(long, value_name = "N", conflicts_with_all = ["shard", "slurm"], value_parser = clap::value_parser!(u16).range(1..=10_000))]
    merge: Option<u16>,
    /// Print a script that runs the sweep as an array of N jobs of Slurm.
    #[arg(long, value_name = "N", conflicts_with_all = ["shard", "overwrite", "large", "json"], value_parser = clap::value_parser!(u16).range(1..=10_000))]
    slurm: Option<u16>,
    #[command(flatten)]
    files: FileArgs,
    /// Allow runs whose results are more than 1 GB, which are temporary.
    #[arg(long, conflicts_with = "merge")]
    large: bool,
    /// Print the summary as JSON, for scripts, and errors as JSON on standard error.
    #[arg(long)]
    json: bool,
}

impl Sweep {
    pub fn execute(self, mut session: Session) -> Result<(), Failure> {
        let Self { sweep: file, output, shard, merge, slurm, files: FileArgs { overwrite }, large, json } = self;
        GivenFile::expect(&file, &[GivenFile::Sweep], "the file of a sweep (docs/reference/cli.md)")?;
        output::require_file("--output", output.as_deref())?;
        let output = output.unwrap_or_else(|| {
            Path::new("out").join(file.file_stem().unwrap_or("sweep".as_ref())).with_extension("h5")
        });
        if let Some(count) = slurm {
            let script = sweep::slurm_script(&file, &output, count.into());
            return output::written(write!(std::io::stdout(), "{script}"));
        }
        let report = match merge {
            Some(count) => sweep::merge(&file, &output, count.into(), overwrite)?,
            None => {
                let threads = rayon::current_num_threads();
                let settings = SweepSettings { overwrite, large, threads, builder: session.builder, shard };
                sweep::sweep(&file, &output, &settings, |p| session.bar.sweep(p))?
            }
        };
        drop(session.bar);
        output::print(&report.report(), json)?;
        report.require_a_row()
    }
}
