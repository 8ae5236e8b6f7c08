//! Errors of gmsh, and of Open CASCADE in it.

use std::borrow::Cow;

/// The error that gmsh reports in a line; none in the words of other programs. At its end gmsh only counts its errors.
pub(crate) fn error_in(line: &str) -> Option<String> {
    let line = without_colours(line);
    let of_gmsh = line.trim().strip_prefix("Error").and_then(|rest| rest.trim_start().strip_prefix(':'));
    // Open CASCADE: "**** ERR StepFile : Undefined Parsing: …    ****".
    let of_kernel = || line.split_once("ERR ").filter(|(stars, _)| stars.trim_matches('*').trim().is_empty());
    let error = of_gmsh.or_else(|| of_kernel().map(|(_, error)| error))?.trim_matches(['*', ' ']);
    error.contains(char::is_alphabetic).then(|| error.to_owned())
}

/// An error of gmsh in the text of a file, `'FILE', line N: …`, without what it quotes: a file that another one names may be any file of the
/// user's.
pub(crate) fn without_words(error: &str) -> Cow<'_, str> {
    const LINE: &str = "', line ";
    let Some(digits) = error.find(LINE).map(|at| at + LINE.len()) else { return Cow::Borrowed(error) };
    let end =
        error[digits..].find(|letter: char| !letter.is_ascii_digit()).map_or(error.len(), |length| digits + length);
    Cow::Owned(format!("{}: an error, whose words gmsh shows", &error[..end]))
}

/// A line without the sequences that colour a terminal.
fn without_colours(line: &str) -> String {
    let mut parts = line.split('\u{1b}');
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |text, part| text + part.split_once('m').map_or(part, |(_, after)| after))
}

#[cfg(test)]
mod tests {
    use super::{error_in, without_words};

    #[test]
    fn words_of_a_file_are_not_in_its_errors() {
        let without = without_words("'a/b.geo', line 12: syntax error (secret)");
        assert_eq!(without, "'a/b.geo', line 12: an error, whose words gmsh shows");
        assert_eq!(without_words("No elements in volume 1"), "No elements in volume 1");
    }

    /// In the words of gmsh 4.8.4.
    #[test]
    fn the_first_error_is_not_the_line_of_dashes_at_the_end() {
        let mesher = "Warning : Some of it\nError   : PLC Error:  A segment and a facet intersect at point\n\
                      Error   : No elements in volume 1\nError   : ------------------------------\n\
                      Error   : Mesh generation error summary\nError   : ------------------------------\n";
        let found = mesher.lines().find_map(error_in);
        assert_eq!(found.as_deref(), Some("PLC Error:  A segment and a facet intersect at point"));
        let kernel = "\u{1b}[31;1m**** ERR StepFile : Undefined Parsing: Line 2: Incorrect syntax    ****\u{1b}[0m\n";
        assert_eq!(
            kernel.lines().find_map(error_in).as_deref(),
            Some("StepFile : Undefined Parsing: Line 2: Incorrect syntax")
        );
        assert_eq!(["Error   : -----", "KeyError: 'x'"].into_iter().find_map(error_in), None);
    }
}
