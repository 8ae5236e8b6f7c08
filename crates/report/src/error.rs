//! Errors of a page.

use std::io;
use std::path::Path;

use diagnostic::{Failure, Kind};

/// The error of a page whose contents do not fit each other.
pub(crate) fn unfit(words: impl Into<String>) -> Failure {
    Kind::Run.alone().says(words)
}

/// The error of a page without something that it has to show.
pub(crate) fn empty(what: &str) -> Failure {
    unfit(format!("the report has no {what}; give it at least one"))
}

/// The error of a file that cannot be written.
pub(crate) fn not_written(path: &Path, error: &io::Error) -> Failure {
    let words = format!("cannot write the report: {error}; check the folder and the room on its disk");
    Kind::Io.of(path).says(words)
}
