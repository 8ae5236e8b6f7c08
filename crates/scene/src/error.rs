//! Why a scene is refused, and how that is shown.

use std::fmt;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::example::example;
use crate::suggest::{list, nearest};

/// Longest piece of a line, of a key or of a value that is shown, in characters.
const SHOWN: usize = 100;

/// Why a scene is refused. The message gives the place, what was found, what was expected and
/// the cure, with the line and a caret under it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The file is not there or cannot be read.
    #[error("{}: the scene file cannot be read: {cause}\n = {cure}", .path.display())]
    Unreadable {
        /// The scene file.
        path: PathBuf,
        /// What the system said.
        cause: io::Error,
        /// What to do about it.
        cure: &'static str,
    },
    /// The file is longer than a scene can be.
    #[error(
        "{}: the scene file is longer than {limit} bytes\n \
         = name a scene file; the mesh goes into a file of its own, named by `body.mesh`, and so does a long table of a \
         history, named by `file`",
        .path.display()
    )]
    TooLarge {
        /// The scene file.
        path: PathBuf,
        /// The most that is read, bytes.
        limit: u64,
    },
    /// The file is not text in UTF-8.
    #[error(
        "{}:{line}: the scene file is not text in UTF-8: found byte 0x{byte:02x} here\n \
         = save it with encoding UTF-8",
        .path.display()
    )]
    NotUtf8 {
        /// The scene file.
        path: PathBuf,
        /// Line of the first byte that is not UTF-8, from 1.
        line: usize,
        /// That byte.
        byte: u8,
    },
    /// The text is not TOML.
    #[error("{}", .at.show(&format!("this is not TOML: {message}"), syntax_cure(.message)))]
    Syntax {
        /// Where; its key is empty.
        at: Box<Place>,
        /// What the TOML parser said.
        message: String,
    },
    /// A key that does not exist, most often misspelt.
    #[error("{}", show_unknown(.at, "key", .key, .known))]
    UnknownKey {
        /// Where.
        at: Box<Place>,
        /// The key that was found.
        key: String,
        /// The keys that are possible there.
        known: Vec<&'static str>,
    },
    /// A kind, scheme or frame that does not exist, most often misspelt.
    #[error("{}", show_unknown(.at, "value", .found, .known))]
    UnknownName {
        /// Where.
        at: Box<Place>,
        /// The name that was found.
        found: String,
        /// The names that are possible there.
        known: Vec<&'static str>,
    },
    /// A required key or section is absent.
    #[error("{}", show_missing(.at, .key))]
    MissingKey {
        /// Where it is missed; the key path is that of the absent key.
        at: Box<Place>,
        /// The absent key.
        key: String,
    },
    /// A value of the wrong type or out of range, or values that contradict each other.
    #[error("{}", .at.show(&format!("found {found}, expected {expected}"), cure))]
    Invalid {
        /// Where.
        at: Box<Place>,
        /// What was found.
        found: String,
        /// What was expected.
        expected: String,
        /// What to do about it.
        cure: String,
    },
}

impl SceneError {
    /// Where in the scene file; `None` if it could not be read as text, or is too long.
    pub fn place(&self) -> Option<&Place> {
        match self {
            Self::Unreadable { .. } | Self::TooLarge { .. } | Self::NotUtf8 { .. } => None,
            Self::Syntax { at, .. }
            | Self::UnknownKey { at, .. }
            | Self::UnknownName { at, .. }
            | Self::MissingKey { at, .. }
            | Self::Invalid { at, .. } => Some(at),
        }
    }
}

/// A place in a scene file. Displayed as `file:line:column: ` and the key.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The scene file.
    pub file: PathBuf,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Path of keys, e.g. `loads[0].history.duration`; empty if unknown.
    pub key: String,
    /// The line, or the piece of a very long one around the column; `None` if it is not to be shown.
    excerpt: Option<String>,
    /// What is meant, in characters of the excerpt.
    mark: Range<usize>,
}

impl Place {
    /// The place of the bytes `span` of `text`. What is beyond the first line is left out.
    pub(crate) fn new(file: &Path, text: &str, span: Range<usize>, key: String) -> Self {
        let start = char_boundary(text, span.start);
        let end = char_boundary(text, span.end).max(start);
        let (before, after) = text.split_at(start);
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        let line_end = start + after.find('\n').unwrap_or(after.len());

        let line: Vec<char> = text[line_start..line_end].trim_end().chars().collect();
        let column = text[line_start..start].chars().count();
        let width = text[start..end.min(line_end)].trim_end().chars().count().max(1);

        let first = if line.len() > SHOWN { column.saturating_sub(SHOWN / 2) } else { 0 };
        let printable = |&c: &char| if c.is_control() { ' ' } else { c };
        Self {
            file: file.to_owned(),
            line: 1 + before.matches('\n').count(),
            column: 1 + column,
            key,
            excerpt: Some(line.iter().skip(first).take(SHOWN).map(printable).collect()),
            mark: column - first..(column + width - first).min(SHOWN.max(column - first + 1)),
        }
    }

    /// The line of a file that a scene names, none of which is shown: what it names may be any file of the user's, such as
    /// one with passwords, and the scene from elsewhere.
    pub(crate) fn unseen(file: &Path, line: usize, key: String) -> Self {
        Self { file: file.to_owned(), line, column: 1, key, excerpt: None, mark: 0..0 }
    }

    /// The refusal of the value at this place.
    pub fn refuse(self, found: impl Into<String>, expected: impl Into<String>, cure: impl Into<String>) -> SceneError {
        let (found, expected, cure) = (found.into(), expected.into(), cure.into());
        SceneError::Invalid { at: self.into(), found, expected, cure }
    }

    /// The place, the headline, the line with what is meant underlined, and the cure.
    fn show(&self, headline: &str, cure: &str) -> String {
        let line = self.line.to_string();
        let gutter = " ".repeat(line.len());
        let Some(excerpt) = &self.excerpt else { return format!("{self}: {headline}\n{gutter} = {cure}") };
        let indent = " ".repeat(self.mark.start);
        let carets = "^".repeat(self.mark.len());
        let cure = cure.replace('\n', &format!("\n{gutter}   "));
        format!("{self}: {headline}\n{gutter} |\n{line} | {excerpt}\n{gutter} | {indent}{carets}\n{gutter} = {cure}",)
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}:{}", self.file.display(), self.line, self.column)?;
        if self.key.is_empty() {
            return Ok(());
        }
        write!(f, ": `{}`", shorten(&self.key))
    }
}

/// The text, cut if it is very long, on one line.
pub(crate) fn shorten(text: &str) -> String {
    let mut words = text.split_whitespace();
    let mut short = words.next().unwrap_or_default().to_owned();
    for word in words.take(SHOWN) {
        short.push(' ');
        short.push_str(word);
    }
    match short.char_indices().nth(SHOWN) {
        Some((cut, _)) => format!("{}…", &short[..cut]),
        None => short,
    }
}

fn show_unknown(at: &Place, what: &str, found: &str, known: &[&str]) -> String {
    let shown = shorten(found);
    match nearest(found, known) {
        Some(near) => at.show(
            &format!("unknown {what} `{shown}`; did you mean `{near}`?"),
            &format!("rename it to `{near}` (possible here: {})", list(known)),
        ),
        None => at.show(&format!("unknown {what} `{shown}`"), &format!("possible here: {}", list(known))),
    }
}

fn show_missing(at: &Place, key: &str) -> String {
    let headline = format!("`{key}` is missing");
    match example(&at.key) {
        Some(example) => at.show(&headline, &format!("add it, for example:\n{example}")),
        None => at.show(&headline, "add it"),
    }
}

fn syntax_cure(message: &str) -> &'static str {
    match message {
        "duplicate key" => "keep one of the two",
        _ => "correct it; a line is `key = value` or `[section]`, and text stands in quotes",
    }
}

/// The end of the text, or the last start of a character not after `index`.
fn char_boundary(text: &str, index: usize) -> usize {
    let at_most = index.min(text.len());
    (0..=at_most).rev().find(|&i| text.is_char_boundary(i)).unwrap_or(0)
}
