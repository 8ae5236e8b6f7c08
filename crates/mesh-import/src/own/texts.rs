//! The files of a deck as lines, each included file in its place.

use std::borrow::Cow;
use std::fmt;

use crate::contents::ReadFile;
use crate::error::ImportError;

/// Includes that are followed, those of a file that is included twice counted twice.
const MAX_INCLUDES: usize = 10_000;

/// A line of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Place {
    /// Number of the file, from 0, the deck itself.
    file: usize,
    /// From 1.
    line: usize,
}

impl Place {
    /// The first line of a file.
    pub(crate) const FIRST: Self = Self { file: 0, line: 1 };
}

/// The files of a deck as texts.
pub(crate) struct Texts<'f> {
    files: &'f [ReadFile],
    texts: Vec<Cow<'f, str>>,
}

/// A line of data.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Data<'t> {
    pub(crate) place: Place,
    pub(crate) text: &'t str,
}

impl<'t> Data<'t> {
    /// The fields between commas, without spaces; the last may be empty.
    pub(crate) fn fields(&self) -> impl Iterator<Item = &'t str> + use<'t> {
        self.text.split(',').map(str::trim)
    }

    /// Fields without the empty one after a comma at the end.
    pub(crate) fn words(&self) -> Vec<&'t str> {
        let mut words: Vec<&str> = self.fields().collect();
        while words.last().is_some_and(|word| word.is_empty()) {
            words.pop();
        }
        words
    }
}

impl<'f> Texts<'f> {
    pub(crate) fn new(files: &'f [ReadFile]) -> Self {
        let text = |file: &'f ReadFile| String::from_utf8_lossy(file.bytes.as_deref().unwrap_or_default());
        Self { files, texts: files.iter().map(text).collect() }
    }

    /// The same with spaces for tabs, to columns of eight.
    pub(crate) fn without_tabs(files: &'f [ReadFile]) -> Self {
        let mut texts = Self::new(files);
        for text in texts.texts.iter_mut().filter(|text| text.contains('\t')) {
            let mut spaced = String::with_capacity(text.len());
            let mut column = 0;
            for letter in text.chars() {
                match letter {
                    '\t' => {
                        let count = 8 - column % 8;
                        spaced.extend(std::iter::repeat_n(' ', count));
                        column += count;
                    }
                    '\n' | '\r' => {
                        spaced.push(letter);
                        column = 0;
                    }
                    _ => {
                        spaced.push(letter);
                        column += 1;
                    }
                }
            }
            *text = Cow::Owned(spaced);
        }
        texts
    }

    /// A refusal that names a line.
    pub(crate) fn refuse(&self, place: Place, found: impl fmt::Display, help: &str) -> ImportError {
        let named = |file: usize| self.files.get(file).map_or_else(String::new, |file| file.path.display().to_string());
        ImportError::Refused {
            source_name: named(0),
            found: format!("line {} of {}: {found}", place.line, named(place.file)),
            help: help.to_owned(),
        }
    }

    /// A line in quotes; of a file that another file names nothing, since that may be any file.
    pub(crate) fn shown(&self, data: Data<'_>) -> String {
        match self.files.get(data.place.file) {
            Some(file) if !file.is_hidden => format!("`{}`", data.text.chars().take(80).collect::<String>()),
            _ => "a line".to_owned(),
        }
    }

    /// A line by its number and its file.
    pub(crate) fn named(&self, place: Place) -> String {
        match (place.file, self.files.get(place.file)) {
            (1.., Some(file)) => format!("line {} of {}", place.line, file.path.display()),
            _ => format!("line {}", place.line),
        }
    }

    /// All lines of the deck, with the lines of what it includes in their place.
    pub(crate) fn lines(&self) -> Result<Vec<Data<'_>>, ImportError> {
        let (mut lines, mut includes) = (Vec::new(), 0);
        self.add_lines(0, &mut lines, &mut includes)?;
        Ok(lines)
    }

    // Files do not include each other in a circle, and there are a thousand at the most: `deck` has looked.
    fn add_lines<'t>(&'t self, file: usize, lines: &mut Vec<Data<'t>>, count: &mut usize) -> Result<(), ImportError> {
        let text: &'t str = self.texts.get(file).map_or("", |text| text);
        let includes = self.files.get(file).map(|file| &file.includes);
        let mut line = 1;
        for (part, text) in text.split_inclusive(['\n', '\r']).enumerate() {
            let place = Place { file, line };
            line += usize::from(text.ends_with('\n'));
            lines.push(Data { place, text: text.trim_start_matches('\u{feff}').trim_end() });
            if let Some(included) = includes.and_then(|includes| includes.get(&part)) {
                *count += 1;
                if *count > MAX_INCLUDES {
                    let found = format!("more than {MAX_INCLUDES} files that are included");
                    return Err(self.refuse(place, found, "include each file once"));
                }
                self.add_lines(*included, lines, count)?;
            }
        }
        Ok(())
    }
}

/// A number as decks have it: 1., -.5, 1E3 or 1D3.
pub(crate) fn number(text: &str) -> Option<f64> {
    // `parse` knows words, such as nan, that no deck has.
    if !text.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'+' | b'-' | b'.' | b'e' | b'E' | b'd' | b'D')) {
        return None;
    }
    let number: f64 = text.replace(['d', 'D'], "e").parse().ok()?;
    number.is_finite().then_some(number)
}
