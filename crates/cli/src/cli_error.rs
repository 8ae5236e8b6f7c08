//! Errors of the program itself, outside of the library.

use std::error::Error;
use std::io;
use std::iter::successors;

use diagnostic::{Diagnosis, Diagnostic, Kind};
use flexframe::failure::FailureReport;
use scene::{SceneError, text_of};
use toml::Value;

/// An error of the command line, the terminal or the threads.
#[derive(Debug, thiserror::Error)]
pub enum CliError {
    /// An option has replaced what the scene says, and is refused.
    #[error("{option}: found {found}, expected {expected}\n = {help}")]
    Option { option: &'static str, found: String, expected: String, help: String },
    /// RAYON_NUM_THREADS is not a number of threads.
    #[error(
        "the environment variable RAYON_NUM_THREADS: found \"{found}\", expected a number from 1 to {most}\n = \
         correct it, remove it, or give --threads"
    )]
    ThreadsVariable { found: String, most: u16 },
    /// The system gives no threads.
    #[error("{} cannot be started: {reason}\n = ask for fewer with --threads", match count {
        Some(count) => format!("{count} threads"),
        None => "the threads, one for each core,".to_owned(),
    })]
    Threads { count: Option<u16>, reason: String },
    /// Signals cannot be listened to.
    #[error("cannot listen to signals: {0}; allow the program another thread and a few open files")]
    Signals(#[source] io::Error),
    /// Standard output takes nothing.
    #[error(
        "standard output cannot be written: {0}\n = send it where there is room; files that the command has written are \
         complete"
    )]
    Output(#[source] io::Error),
    /// A port that somebody else has, or may not be had.
    #[error(
        "port {port} of 127.0.0.1 cannot be taken: {source}\n = leave --port out, so that one that is free is taken"
    )]
    Port { port: u16, source: io::Error },
    /// The folder for a run that is played.
    #[error("{0}")]
    Folder(#[source] io::Error),
    /// The summary has no form in JSON.
    #[error("the summary cannot be written as JSON: {0}\n = leave --json out, and please report this")]
    Json(#[from] serde_json::Error),
}

/// The failure of any error that ends a command, in which values were set on the command line.
pub fn report(error: &dyn Diagnostic, set: &[(String, Value)]) -> FailureReport {
    of_set_value(error, set).unwrap_or_else(|| FailureReport::of(error))
}

/// The failure of a scene in which values were set: at the option, where it is one of them, and at the line that the scene file has.
fn of_set_value(error: &dyn Diagnostic, set: &[(String, Value)]) -> Option<FailureReport> {
    let sources = successors(Some(error as &(dyn Error + 'static)), |&error| error.source());
    let refused = sources.filter_map(|error| error.downcast_ref::<SceneError>()).next()?;
    let place = refused.place()?;
    let is_at =
        |key: &str| place.key.strip_prefix(key).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']));
    if let Some((key, value)) = set.iter().rev().find(|(key, _)| is_at(key)) {
        let (found, expected, help) = (refused.found(), refused.expected(), refused.help());
        let words = match (&found, &expected) {
            (None, expected) => format!("{} is missing", expected.as_deref().unwrap_or("a key")),
            (Some(found), None) => format!("found {found}"),
            (Some(found), Some(expected)) => format!("found {found}, expected {expected}"),
        };
        let cure = help.as_ref().map_or_else(String::new, |help| format!("\n = {help}"));
        return Some(FailureReport::new(
            format!("--set {key}={value}: {words}{cure}"),
            Diagnosis { line: None, ..refused.diagnosis() },
        ));
    }
    let moved = refused.at_line_of(&text_of(&place.file).ok().filter(|_| !set.is_empty())?)?;
    let whole = FailureReport::of(error);
    Some(whole.with_message(|message| message.replacen(&refused.to_string(), &moved.to_string(), 1), moved.line()))
}

impl Diagnostic for CliError {
    fn diagnosis(&self) -> Diagnosis {
        match self {
            Self::Option { option, found, expected, help } => {
                Kind::Usage.alone().key(*option).found(found).expected(expected).help(help)
            }
            Self::ThreadsVariable { found, most } => {
                let expected = format!("a number from 1 to {most}");
                Kind::Usage.alone().key("RAYON_NUM_THREADS").found(found).expected(expected)
            }
            Self::Output(_) => Kind::Io.of("standard output"),
            Self::Threads { .. } | Self::Signals(_) | Self::Port { .. } | Self::Folder(_) => Kind::Io.alone(),
            Self::Json(_) => Kind::Run.alone(),
        }
    }
}
