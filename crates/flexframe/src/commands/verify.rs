//! `flexframe verify`: published benchmarks, each a folder of data, beside the answers of this program.

mod case;
mod found;
mod outcome;
mod page;

use std::ffi::OsString;
use std::path::Path;

use ::report::Report;
use diagnostic::{Failure, Kind};
use serde_json::Value as Json;

use crate::files::write_error::WriteError;
pub use case::Case;
use found::Answer;
use outcome::{Outcome, Verdict};
pub use page::claim;

/// How far a verification has come: a case begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct VerifyProgress<'a> {
    /// Name of the case.
    pub case: &'a str,
    /// Cases that are done.
    pub done: usize,
    /// All of them.
    pub total: usize,
}

/// The cases of a folder by name, or all of them in the order of their names, those that take seconds alone if `quick`.
///
/// # Errors
/// A folder without cases, an unknown name, a wrong case.
pub fn cases(folder: &Path, names: &[String], quick: bool) -> Result<Vec<Case>, Failure> {
    let known = case::names(folder)?;
    if let Some(found) = names.iter().find(|name| !known.contains(name)) {
        let expected = format!("names of cases in {}: {}", folder.display(), known.join(", "));
        return Err(Kind::Usage.alone().key("CASE").found(found).expected(expected).help("see `verify --list`").into());
    }
    let is_asked = |name: &&String| names.is_empty() || names.contains(name);
    let cases = known.iter().filter(is_asked).map(|name| Case::read(folder, name)).collect::<Result<Vec<_>, _>>()?;
    Ok(cases.into_iter().filter(|case| case.quick || !quick).collect())
}

/// The list of cases, without an answer.
pub fn list(cases: &[Case]) -> Report {
    outcome::list(cases)
}

/// Runs cases one after another and compares. `run` answers a command line with the JSON of its report; it writes its files to a folder
/// under `folder` named after the case. With `pages` a page for each case stands there, too, and one for all. Beside the report is the error that the program ends with: that of the
/// first case that could not be answered, or a miss that no case explains.
///
/// # Errors
/// A page that cannot be written; a stop.
pub fn verify(
    cases: &[Case],
    (folder, pages): (&Path, bool),
    mut run: impl FnMut(&[OsString]) -> Result<Json, Failure>,
    mut progress: impl FnMut(VerifyProgress),
) -> Result<(Report, Option<Failure>), Failure> {
    let (mut outcomes, mut first_failure): (Vec<Vec<Outcome>>, _) = (Vec::new(), None);
    for (done, case) in cases.iter().enumerate() {
        progress(VerifyProgress { case: &case.name, done, total: cases.len() });
        let of_case = folder.join(&case.name);
        std::fs::create_dir_all(&of_case).map_err(WriteError::of(&of_case))?;
        let answer = run(&case.words(&of_case)).map(|report| Answer { report, folder: of_case.clone() });
        let compared = answer.and_then(|answer| Ok((Outcome::all(case, &answer)?, Some(answer))));
        let (compared, answer) = match compared {
            Err(failure) if failure.diagnosis().kind == Kind::Stopped => return Err(failure),
            Err(failure) => {
                let none = Outcome::none(case, &failure);
                let is_known = none.iter().all(|outcome| outcome.verdict() == Verdict::KnownMiss);
                first_failure = first_failure.or_else(|| (!is_known).then_some(failure));
                (none, None)
            }
            Ok(compared) => compared,
        };
        if pages {
            page::write(case, &compared, answer.as_ref(), &of_case)?;
        }
        outcomes.push(compared);
    }
    if pages {
        page::write_all(cases, &outcomes, folder)?;
    }
    let unexplained = || outcomes.iter().flatten().filter(|outcome| outcome.verdict() == Verdict::Miss).count();
    let failure = first_failure.or_else(|| match unexplained() {
        0 => None,
        count => {
            let help =
                "mend the program, or explain it: miss = \"the reason\" in case.toml; a tolerance is not widened";
            Some(Kind::Run.alone().help(help).says(format!("published numbers that were missed: {count}")))
        }
    });
    Ok((outcome::report(cases, &outcomes), failure))
}
