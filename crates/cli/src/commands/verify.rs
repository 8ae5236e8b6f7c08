//! `flexframe verify`.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::Args;
use diagnostic::{Failure, Kind};
use flexframe::outputs::{OutputError, Written};
use flexframe::verify::{cases, claim, list, verify};
use whole_file::TemporaryFolder;

use crate::arguments::FileArgs;
use crate::output;
use crate::progress::Bar;
use crate::session::{Session, Taken};

/// Run published benchmarks and compare: theirs, ours, the tolerance.
///
/// A benchmark is a folder with a scene and a file case.toml (docs/how-to/verify.md). The exit code is 0 if all numbers pass, or are misses
/// whose reason the case names.
#[derive(Debug, Args)]
pub struct Verify {
    /// Names of cases [default: all].
    #[arg(value_name = "CASE")]
    names: Vec<String>,
    /// The folder of cases [default: benchmarks of the current folder, or else of the sources of this program].
    #[arg(long, value_name = "DIR")]
    cases: Option<PathBuf>,
    /// Only cases that take a few seconds.
    #[arg(long)]
    quick: bool,
    /// Print the list of cases, and run none.
    #[arg(long)]
    list: bool,
    /// Folder for a page about all cases, and of each case its scene, its page and the files of its command [default: none is kept].
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    #[command(flatten)]
    files: FileArgs,
    /// Print the summary as JSON, for scripts, and errors as JSON on standard error.
    #[arg(long)]
    json: bool,
}

impl Verify {
    /// Runs the cases; `run` executes a command line.
    pub fn execute(
        self,
        mut session: Session,
        run: fn(&[OsString], Session) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let Self { names, cases: folder, quick, list: only_list, output, files, json } = self;
        output::require_file("--output", output.as_deref())?;
        let cases = cases(&folder.unwrap_or_else(default_folder), &names, quick)?;
        if only_list {
            return session.print(&list(&cases), json);
        }
        output.iter().try_for_each(|folder| Written::FOLDER.check(folder)).map_err(OutputError::from)?;
        output.iter().try_for_each(|folder| claim(&cases, folder, files.overwrite))?;
        let temporary = TemporaryFolder::new()?;
        let to = output.as_deref().unwrap_or(temporary.path());
        let Session { builder, signals, bar, .. } = &mut session;
        let answer = |words: &[OsString]| {
            let taken = Taken::default();
            let (builder, signals, bar) = (builder.clone(), signals.clone(), Bar::new(true));
            run(words, Session { builder, signals, bar, json_errors: true, taken: Some(taken.clone()) })?;
            let none = || Kind::Usage.alone().says("the command of the case has no report");
            taken.get().cloned().ok_or_else(none)
        };
        let (report, failure) = verify(&cases, (to, output.is_some()), answer, |p| bar.verify(p))?;
        session.print(&report, json)?;
        failure.map_or(Ok(()), Err)
    }
}

/// `benchmarks` of the current folder, or else of the sources.
fn default_folder() -> PathBuf {
    let here = PathBuf::from("benchmarks");
    let of_sources = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../benchmarks");
    if here.is_dir() || !of_sources.is_dir() { here } else { of_sources }
}
