//! Places in a scene file, and how they are shown.

use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::text::shorten::{SHOWN, shorten};

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
    /// The marked part, in characters of the excerpt.
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

    /// The same place without its key and its line.
    pub(crate) fn hidden(self) -> Self {
        Self { key: String::new(), excerpt: None, ..self }
    }

    /// The place, the headline, the line with what is meant underlined, and help.
    pub fn show(&self, headline: &str, help: &str) -> String {
        let line = self.line.to_string();
        let gutter = " ".repeat(line.len());
        let Some(excerpt) = &self.excerpt else { return format!("{self}: {headline}\n{gutter} = {help}") };
        let indent = " ".repeat(self.mark.start);
        let carets = "^".repeat(self.mark.len());
        let help = help.replace('\n', &format!("\n{gutter}   "));
        format!("{self}: {headline}\n{gutter} |\n{line} | {excerpt}\n{gutter} | {indent}{carets}\n{gutter} = {help}",)
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

/// The end of the text, or the last start of a character not after `index`.
fn char_boundary(text: &str, index: usize) -> usize {
    let at_most = index.min(text.len());
    (0..=at_most).rev().find(|&i| text.is_char_boundary(i)).unwrap_or(0)
}
