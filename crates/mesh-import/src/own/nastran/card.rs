//! A card: its name and its fields.

use std::borrow::Cow;

use crate::error::ImportError;
use crate::own::texts::{self, Data, Place, Texts};

/// A card with its fields after the name.
#[derive(Debug)]
pub(super) struct Card<'t> {
    pub(super) place: Place,
    /// In capital letters, without the star of wide fields.
    pub(super) name: String,
    pub(super) fields: Vec<Cow<'t, str>>,
    /// Places from 0 and increments of the fields that it has from the card before it.
    pub(super) changes: Vec<(usize, Change)>,
    /// The label in its last line by which another line may continue it, in capital letters; empty where there is none.
    pub(super) label: String,
}

impl<'t> Card<'t> {
    /// A card of one line.
    pub(super) fn new(place: Place, name: String, data: Vec<&'t str>, label: String) -> Self {
        Self { place, name, fields: data.into_iter().map(Cow::Borrowed).collect(), changes: Vec::new(), label }
    }

    /// A field by its number from 1, the one after the name; empty where there is none.
    pub(super) fn field(&self, number: usize) -> &str {
        self.fields.get(number - 1).map_or("", |field| field)
    }

    /// The number of fields up to the last that is not empty.
    pub(super) fn len(&self) -> usize {
        self.fields.iter().rposition(|field| !field.is_empty()).map_or(0, |last| last + 1)
    }

    /// A number in a field; none where it is empty.
    pub(super) fn number(&self, texts: &Texts<'_>, field: usize) -> Result<Option<f64>, ImportError> {
        let text = self.field(field);
        if text.is_empty() {
            return Ok(None);
        }
        number(text).map(Some).ok_or_else(|| self.refuse(texts, field, "a number"))
    }

    /// A number in a field, nought where it is empty.
    pub(super) fn number_or_nought(&self, texts: &Texts<'_>, field: usize) -> Result<f64, ImportError> {
        Ok(self.number(texts, field)?.unwrap_or(0.0))
    }

    /// A whole number in a field; none where it is empty.
    pub(super) fn whole(&self, texts: &Texts<'_>, field: usize) -> Result<Option<u64>, ImportError> {
        let text = self.field(field);
        if text.is_empty() {
            return Ok(None);
        }
        let is_plain = text.bytes().all(|byte| byte.is_ascii_digit());
        let found = if is_plain { text.parse().ok() } else { None };
        found.map(Some).ok_or_else(|| self.refuse(texts, field, "a whole number"))
    }

    /// A whole number above nought in a field that must have one.
    pub(super) fn label(&self, texts: &Texts<'_>, field: usize) -> Result<u64, ImportError> {
        let found = self.whole(texts, field)?.filter(|label| *label > 0);
        found.ok_or_else(|| self.refuse(texts, field, "a whole number above 0"))
    }

    /// The same card in another line.
    pub(super) fn again(&self, place: Place) -> Self {
        let Self { name, fields, changes, .. } = self;
        Self { place, name: name.clone(), fields: fields.clone(), changes: changes.clone(), label: String::new() }
    }

    /// Takes the fields of a line that continues it.
    pub(super) fn goes_on(&mut self, data: Vec<&'t str>, label: String) {
        self.fields.extend(data.into_iter().map(Cow::Borrowed));
        self.label = label;
    }

    fn refuse(&self, texts: &Texts<'_>, field: usize, expected: &str) -> ImportError {
        let text = self.field(field);
        let shown = match text {
            "" => "nothing".to_owned(),
            _ => texts.shown(Data { place: self.place, text }).replace("a line", "other words"),
        };
        let found = format!("in field {} of {}, found {shown}, expected {expected}", field + 1, self.name);
        texts.refuse(
            self.place,
            found,
            "check the card: its fields have 8 letters, 16 after a name with a star, or commas between them",
        )
    }
}

/// An increment of a field.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Change {
    /// A whole number is added.
    Whole(i64),
    /// A number is added.
    Number(f64),
}

/// A number as Nastran writes it, such as 7.+4.
pub(super) fn number(text: &str) -> Option<f64> {
    let mut plain = text.replace(['d', 'D', 'E'], "e");
    if !plain.contains('e')
        && let Some(at) = plain.rfind(['+', '-']).filter(|at| *at > 0)
    {
        plain.insert(at, 'e');
    }
    texts::number(&plain)
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn numbers_may_have_an_exponent_without_a_letter() {
        for (text, wanted) in [
            ("1.5-3", 1.5e-3),
            ("-7.+4", -7e4),
            (".5", 0.5),
            ("1.D3", 1e3),
            ("+2.e-1", 0.2),
            ("3", 3.0),
            ("-1.-1", -0.1),
        ] {
            assert_eq!(number(text), Some(wanted), "{text}");
        }
        for text in ["nan", "1 2", "x", "1.5-", "--1.", "1e999", "+"] {
            assert_eq!(number(text), None, "{text}");
        }
    }
}
