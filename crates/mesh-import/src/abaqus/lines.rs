//! The lines of a deck and what it includes: keywords with their parameters and the lines of data under them.

use std::borrow::Cow;
use std::fmt;

use crate::contents::ReadFile;
use crate::error::ImportError;

/// Includes that are followed, those of a file that is included twice counted twice.
const MAX_INCLUDES: usize = 10_000;

/// A line of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Place {
    /// Number of the file, from 0, the deck itself.
    file: usize,
    /// From 1.
    line: usize,
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

/// A keyword with its parameters and its data.
#[derive(Debug)]
pub(crate) struct Block<'t> {
    pub(crate) place: Place,
    /// In capital letters, with one space between words.
    pub(crate) keyword: String,
    /// Names in capital letters, and values.
    parameters: Vec<(String, &'t str)>,
    pub(crate) data: Vec<Data<'t>>,
}

impl<'t> Block<'t> {
    /// The value of a parameter, empty of one that has none.
    pub(crate) fn parameter(&self, name: &str) -> Option<&'t str> {
        self.parameters.iter().find(|(key, _)| key == name).map(|(_, value)| *value)
    }

    pub(crate) fn has(&self, name: &str) -> bool {
        self.parameter(name).is_some()
    }

    /// True if a parameter has this value, in any letters.
    pub(crate) fn is(&self, name: &str, value: &str) -> bool {
        self.parameter(name).is_some_and(|found| found.eq_ignore_ascii_case(value))
    }
}

impl<'f> Texts<'f> {
    pub(crate) fn new(files: &'f [ReadFile]) -> Self {
        let text = |file: &'f ReadFile| String::from_utf8_lossy(file.bytes.as_deref().unwrap_or_default());
        Self { files, texts: files.iter().map(text).collect() }
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

    /// A line in quotes; of an included file nothing, since that may be any file.
    pub(crate) fn shown(&self, data: Data<'_>) -> String {
        match data.place.file {
            0 => format!("`{}`", data.text.chars().take(80).collect::<String>()),
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

    /// The blocks of the deck, with all that it includes in its place.
    pub(crate) fn blocks(&self) -> Result<Vec<Block<'_>>, ImportError> {
        let mut reading = Reading { texts: self, blocks: Vec::new(), includes: 0, open: false };
        reading.file(0)?;
        Ok(reading.blocks)
    }
}

struct Reading<'t, 'f> {
    texts: &'t Texts<'f>,
    blocks: Vec<Block<'t>>,
    includes: usize,
    /// True if the last keyword ends in a comma, and may go on.
    open: bool,
}

impl<'t> Reading<'t, '_> {
    // Files do not include each other in a circle, and there are a thousand at the most: `deck` has looked.
    fn file(&mut self, file: usize) -> Result<(), ImportError> {
        let text: &'t str = self.texts.texts.get(file).map_or("", |text| text);
        let includes = self.texts.files.get(file).map(|file| &file.includes);
        let mut line = 1;
        for (part, text) in text.split_inclusive(['\n', '\r']).enumerate() {
            let place = Place { file, line };
            line += usize::from(text.ends_with('\n'));
            self.line(place, text.trim_start_matches('\u{feff}').trim())?;
            if let Some(included) = includes.and_then(|includes| includes.get(&part)) {
                self.include(place, *included)?;
            }
        }
        Ok(())
    }

    fn line(&mut self, place: Place, text: &'t str) -> Result<(), ImportError> {
        if text.is_empty() || text.starts_with("**") {
            return Ok(());
        }
        if let Some(rest) = text.strip_prefix('*') {
            let mut parts = rest.split(',');
            let first = parts.next().unwrap_or_default();
            let keyword = first.split_whitespace().collect::<Vec<_>>().join(" ").to_uppercase();
            self.open = rest.ends_with(',');
            // What it includes stands in its place.
            if keyword != "INCLUDE" {
                self.blocks.push(Block { place, keyword, parameters: parameters(parts), data: Vec::new() });
            }
            return Ok(());
        }
        if std::mem::take(&mut self.open) && is_more(text) {
            self.open = text.ends_with(',');
            if let Some(block) = self.blocks.last_mut() {
                block.parameters.extend(parameters(text.split(',')));
            }
            return Ok(());
        }
        let data = Data { place, text };
        match self.blocks.last_mut() {
            Some(block) => block.data.push(data),
            None => {
                let found = format!("{} before any keyword", self.texts.shown(data));
                return Err(self.texts.refuse(place, found, "begin the deck with a keyword, such as *HEADING"));
            }
        }
        Ok(())
    }

    fn include(&mut self, place: Place, number: usize) -> Result<(), ImportError> {
        self.includes += 1;
        if self.includes > MAX_INCLUDES {
            let found = format!("more than {MAX_INCLUDES} files that are included");
            return Err(self.texts.refuse(place, found, "include each file once"));
        }
        self.file(number)
    }
}

fn parameters<'t>(parts: impl Iterator<Item = &'t str>) -> Vec<(String, &'t str)> {
    let parameter = |part: &'t str| {
        let (key, value) = part.split_once('=').unwrap_or((part, ""));
        let key = key.split_whitespace().collect::<Vec<_>>().join(" ").to_uppercase();
        (key, value.trim().trim_matches('"'))
    };
    parts.filter(|part| !part.trim().is_empty()).map(parameter).collect()
}

/// True if a line after a keyword that ends in a comma has more parameters, and no data.
fn is_more(text: &str) -> bool {
    let flags = ["GENERATE", "UNSORTED", "INTERNAL"];
    let first = text.split(',').next().unwrap_or_default().trim();
    text.contains('=') || flags.iter().any(|flag| first.eq_ignore_ascii_case(flag))
}

/// A number as decks have it: 1., -.5, 1E3 or 1D3; an empty field is nought.
pub(crate) fn number(text: &str) -> Option<f64> {
    if text.is_empty() {
        return Some(0.0);
    }
    // `parse` knows words, such as nan, that no deck has.
    if !text.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'+' | b'-' | b'.' | b'e' | b'E' | b'd' | b'D')) {
        return None;
    }
    let number: f64 = text.replace(['d', 'D'], "e").parse().ok()?;
    number.is_finite().then_some(number)
}
