//! Why a scene is refused, and how that is shown.

use std::fmt;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::example::example;
use crate::suggest::{list, nearest};

/// Longest piece of a line, of a key or of a value that is shown, in characters.
const SHOWN: usize = 100;

const TOO_LARGE_CURE: &str = "name a scene file; the mesh goes into a file of its own, named by `body.mesh`, and so does a \
                              long table of a history, named by `file`";
const NOT_UTF8_CURE: &str = "save it with encoding UTF-8";

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
    #[error("{}: the scene file is longer than {limit} bytes\n = {TOO_LARGE_CURE}", .path.display())]
    TooLarge {
        /// The scene file.
        path: PathBuf,
        /// The most that is read, bytes.
        limit: u64,
    },
    /// The file is not text in UTF-8.
    #[error(
        "{}:{line}: the scene file is not text in UTF-8: found byte 0x{byte:02x} here\n = {NOT_UTF8_CURE}",
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

    /// The scene file.
    pub fn file(&self) -> &Path {
        match self {
            Self::Unreadable { path, .. } | Self::TooLarge { path, .. } | Self::NotUtf8 { path, .. } => path,
            Self::Syntax { at, .. }
            | Self::UnknownKey { at, .. }
            | Self::UnknownName { at, .. }
            | Self::MissingKey { at, .. }
            | Self::Invalid { at, .. } => &at.file,
        }
    }

    /// Line in the scene file, from 1, where the fault is in one.
    pub fn line(&self) -> Option<usize> {
        match self {
            Self::NotUtf8 { line, .. } => Some(*line),
            _ => self.place().map(|place| place.line),
        }
    }

    /// What stands there, where something does.
    pub fn found(&self) -> Option<String> {
        match self {
            Self::Unreadable { .. } | Self::TooLarge { .. } | Self::Syntax { .. } | Self::MissingKey { .. } => None,
            Self::NotUtf8 { byte, .. } => Some(format!("byte 0x{byte:02x}")),
            Self::UnknownKey { key: found, .. } | Self::UnknownName { found, .. } => Some(shorten(found)),
            Self::Invalid { found, .. } => Some(found.clone()),
        }
    }

    /// What should stand there, where that is known.
    pub fn expected(&self) -> Option<String> {
        match self {
            Self::Unreadable { .. } => None,
            Self::TooLarge { limit, .. } => Some(format!("at most {limit} bytes")),
            Self::NotUtf8 { .. } => Some("text in UTF-8".to_owned()),
            Self::Syntax { .. } => Some("TOML".to_owned()),
            Self::UnknownKey { known, .. } | Self::UnknownName { known, .. } => {
                Some(format!("one of {}", list(known))).filter(|_| !known.is_empty())
            }
            Self::MissingKey { key, .. } => Some(format!("`{key}`")),
            Self::Invalid { expected, .. } => Some(expected.clone()),
        }
    }

    /// What to do about it.
    pub fn cure(&self) -> Option<String> {
        match self {
            Self::Unreadable { cure, .. } => Some((*cure).to_owned()),
            Self::TooLarge { .. } => Some(TOO_LARGE_CURE.to_owned()),
            Self::NotUtf8 { .. } => Some(NOT_UTF8_CURE.to_owned()),
            Self::Syntax { message, .. } => Some(syntax_cure(message).to_owned()),
            Self::UnknownKey { key: found, known, .. } | Self::UnknownName { found, known, .. } => {
                Some(unknown_cure(found, known))
            }
            Self::MissingKey { at, .. } => Some(missing_cure(at)),
            Self::Invalid { cure, .. } => Some(cure.clone()),
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
    let question = nearest(found, known).map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
    at.show(&format!("unknown {what} `{shown}`{question}"), &unknown_cure(found, known))
}

fn unknown_cure(found: &str, known: &[&str]) -> String {
    match nearest(found, known) {
        Some(near) => format!("rename it to `{near}` (possible here: {})", list(known)),
        None => format!("possible here: {}", list(known)),
    }
}

fn show_missing(at: &Place, key: &str) -> String {
    at.show(&format!("`{key}` is missing"), &missing_cure(at))
}

fn missing_cure(at: &Place) -> String {
    match example(&at.key) {
        Some(example) => format!("add it, for example:\n{example}"),
        None => "add it".to_owned(),
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
