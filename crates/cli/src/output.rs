//! Standard output and standard error, either of which may be full or closed.

use std::borrow::Cow;
use std::fmt::Display;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use diagnostic::Failure;
use flexframe::failure::FailureReport;
use flexframe::run::Estimate;
use model::CacheNotes;
use serde::Serialize;

use crate::cli_error::{no_json, option, standard_output};

/// A text as a terminal may have it: names that come from files may hold characters that move its cursor, change its colours or turn
/// the direction of writing.
fn for_terminal(text: &str) -> Cow<'_, str> {
    let is_plain = |letter: char| match letter {
        '\n' | '\t' => true,
        '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => false,
        letter => !letter.is_control(),
    };
    if text.chars().all(is_plain) {
        return text.into();
    }
    let escaped =
        |letter: char| if is_plain(letter) { letter.to_string() } else { letter.escape_unicode().to_string() };
    text.chars().map(escaped).collect::<String>().into()
}

/// Prints a summary.
pub fn print<R: Serialize + Display>(report: &R, json: bool) -> Result<(), Failure> {
    let report = match json {
        true => serde_json::to_string_pretty(report).map_err(|error| no_json(&error))?,
        false => report.to_string(),
    };
    if json {
        text(&format!("{report}\n"))?
    } else {
        line(&report)?
    }
    Ok(())
}

/// Stands for standard output, where a file is written that is text.
const STANDARD_OUTPUT: &str = "-";

/// True if a file is to go to standard output.
pub fn is_standard(file: &Path) -> bool {
    file == Path::new(STANDARD_OUTPUT)
}

/// Refuses standard output for what is not a text: a folder, or a file of bytes.
pub fn require_file(name: &str, file: Option<&Path>) -> Result<(), Failure> {
    match file {
        Some(file) if is_standard(file) => {
            let expected = "the name of a file or folder: only texts can go to standard output";
            Err(option(name, "-, which stands for standard output", expected, "name it (./- is a file of that name)"))
        }
        _ => Ok(()),
    }
}

/// Prints a text as it is.
pub fn text(text: &str) -> Result<(), Failure> {
    written(write!(io::stdout(), "{text}"))
}

/// Tells on standard error what is doubtful, before the work.
pub fn doubts(doubts: impl IntoIterator<Item = impl Display>) {
    for doubt in doubts {
        // Where it cannot be written, nothing is lost: the summary has it, too.
        let _ = writeln!(io::stderr(), "warning: {}", for_terminal(&doubt.to_string()));
    }
}

/// Writes the estimate of a run to standard error.
pub fn show_estimate(estimate: &Estimate) {
    // Where it cannot be written, nothing is lost but words.
    let _ = writeln!(io::stderr(), "run: {estimate}");
}

/// Prints the names of files.
pub fn list(files: &[PathBuf]) -> Result<(), Failure> {
    files.iter().try_for_each(|file| line(&format!("  wrote    {}", file.display())))
}

/// Prints what should be known of files.
pub fn warn(warning: Option<&str>) -> Result<(), Failure> {
    warning.map_or(Ok(()), |warning| line(&format!("  warning  {warning}")))
}

/// Writes the use of the cache to standard error.
pub fn notes(notes: &CacheNotes) {
    let &CacheNotes { read, computed, .. } = notes;
    let used = match (read, computed) {
        (0, _) => None,
        (_, 0) => Some("reduced body: all parts were read from its file or the cache".to_owned()),
        _ => Some(format!("reduced body: {read} parts were read from its file or the cache, {computed} were computed")),
    };
    for text in used.iter().chain(notes.warnings.iter()) {
        // Where it cannot be written, nothing is lost but words.
        let _ = writeln!(io::stderr(), "note: {}", for_terminal(text));
    }
}

pub fn line(line: &str) -> Result<(), Failure> {
    written(writeln!(io::stdout(), "{}", for_terminal(line)))
}

/// Result of a write to standard output. A reader such as `head` that has had enough is no error.
pub fn written(result: io::Result<()>) -> Result<(), Failure> {
    match result.and_then(|()| io::stdout().flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(standard_output(&error)),
        _ => Ok(()),
    }
}

/// Tells of a failure on standard error: as a message, or as a line of JSON.
pub fn report(report: &FailureReport, json: bool) {
    let text = if json { serde_json::to_string(report).unwrap_or_default() } else { report.to_string() };
    let text = if json { text.into() } else { for_terminal(&text) };
    // Where it cannot be written, the exit code still tells.
    let _ = writeln!(io::stderr(), "{text}");
}

#[cfg(test)]
mod tests {
    use super::for_terminal;

    #[test]
    fn foreign_names_do_not_steer_a_terminal() {
        let plain = "  Körper 1\n\tµm, 5 °\n";
        assert_eq!(for_terminal(plain), plain);
        assert_eq!(for_terminal("a\u{1b}[2Jb\r\u{9b}c\u{202e}d\u{7f}"), r"a\u{1b}[2Jb\u{d}\u{9b}c\u{202e}d\u{7f}");
    }
}
