//! The example scene, and how a change to it is refused.

use scene::{Body, SceneError};

pub const EXAMPLE: &str = include_str!("../../src/text/example.toml");

/// The error of the example after `from` has been replaced by `to`.
pub fn refusal(from: &str, to: &str) -> (String, SceneError) {
    assert_eq!(EXAMPLE.matches(from).count(), 1, "{from:?} is not unique in the example");
    let text = EXAMPLE.replace(from, to);
    match Body::parse(&text, "dir/plate.toml") {
        Ok(_) => panic!("{to:?} was accepted"),
        Err(error) => (text, error),
    }
}

/// Asserts that `to` in place of `from` is refused at the text `mark`, for `key`, with `words`.
#[track_caller]
pub fn refused(from: &str, to: &str, mark: &str, key: &str, words: &[&str]) {
    let (text, error) = refusal(from, to);
    let message = error.to_string();
    let place = error.place().unwrap_or_else(|| panic!("no place in {message}"));

    let start = text.find(mark).unwrap_or_else(|| panic!("no {mark:?} in the text"));
    let line = 1 + text[..start].matches('\n').count();
    let column = 1 + start - text[..start].rfind('\n').map_or(0, |newline| newline + 1);
    assert_eq!((place.line, place.column, place.key.as_str()), (line, column, key), "{message}");

    let head = match key {
        "" => format!("dir/plate.toml:{line}:{column}: "),
        key => format!("dir/plate.toml:{line}:{column}: `{key}`: "),
    };
    assert!(message.starts_with(&head), "no {head:?} in {message}");
    let source_line = text.lines().nth(line - 1).unwrap();
    let shown: String = source_line.chars().take(60).collect();
    assert!(message.contains(&format!("\n{line} | {}", shown.trim_end())), "{message}");
    let caret_line = message.lines().nth(3).unwrap();
    let caret = caret_line.find('^').unwrap() - caret_line.find('|').unwrap() - 1;
    assert_eq!(caret, column, "{message}");
    assert!(message.contains("\n   = ") || message.contains("\n  = "), "no help in {message}");
    for word in words {
        assert!(message.contains(word), "no {word:?} in {message}");
    }
}
