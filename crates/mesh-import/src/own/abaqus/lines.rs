//! The lines of a deck: keywords with their parameters and the lines of data under them.

use crate::error::ImportError;
use crate::own::abaqus::keywords::spaced;
use crate::own::texts::{self, Data, Place, Texts};

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

/// The blocks of a deck, with all that it includes in its place.
pub(crate) fn blocks<'t>(texts: &'t Texts<'_>) -> Result<Vec<Block<'t>>, ImportError> {
    let mut reading = Reading { texts, blocks: Vec::new(), open: false };
    for Data { place, text } in texts.lines()? {
        reading.line(place, text.trim())?;
    }
    Ok(reading.blocks)
}

struct Reading<'t, 'f> {
    texts: &'t Texts<'f>,
    blocks: Vec<Block<'t>>,
    /// True if the last keyword ends in a comma, and may go on.
    open: bool,
}

impl<'t> Reading<'t, '_> {
    fn line(&mut self, place: Place, text: &'t str) -> Result<(), ImportError> {
        if text.is_empty() || text.starts_with("**") {
            return Ok(());
        }
        if let Some(rest) = text.strip_prefix('*') {
            let mut parts = rest.split(',');
            let first = parts.next().unwrap_or_default();
            let keyword = spaced(first.split_whitespace().collect::<Vec<_>>().join(" ").to_uppercase());
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
    if text.is_empty() { Some(0.0) } else { texts::number(text) }
}
