//! Errors of the program itself, outside of the library.

use std::error::Error;
use std::io;
use std::iter::successors;

use diagnostic::{Diagnosis, Diagnostic, Failure, Kind};
use flexframe::failure::FailureReport;
use scene::{SceneError, text_of};
use toml::Value;

/// The refusal of an option that has replaced what the scene says, or of its value.
pub fn option(option: &str, found: impl Into<String>, expected: impl Into<String>, help: impl Into<String>) -> Failure {
    Kind::Usage.alone().key(option).found(found).expected(expected).help(help).into()
}

/// The error of standard output that takes nothing.
pub fn standard_output(error: &io::Error) -> Failure {
    let help = "send it where there is room; files that the command has written are complete";
    Kind::Io.of("standard output").help(help).says(format!("cannot be written: {error}"))
}

/// The error of a summary that has no form in JSON.
pub fn no_json(error: &serde_json::Error) -> Failure {
    let help = "leave --json out, and please report this";
    Kind::Run.alone().help(help).says(format!("the summary cannot be written as JSON: {error}"))
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
