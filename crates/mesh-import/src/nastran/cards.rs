//! The cards of a deck: fields of 8 or 16 letters or between commas, and the lines that continue them.

use crate::error::ImportError;
use crate::texts::{self, Data, Place, Texts};

/// A card with its fields after the name.
#[derive(Debug)]
pub(super) struct Card<'t> {
    pub(super) place: Place,
    /// In capital letters, without the star of wide fields.
    pub(super) name: String,
    fields: Vec<&'t str>,
}

/// The bulk data.
pub(super) struct Bulk<'t> {
    pub(super) cards: Vec<Card<'t>>,
    /// Lines after ENDDATA.
    pub(super) lines_after: usize,
}

/// The fields of a line: its first, its data, and the label of the line that continues it.
struct Line<'t> {
    head: &'t str,
    data: Vec<&'t str>,
    label: &'t str,
}

impl<'t> Card<'t> {
    /// A field by its number from 1, the one after the name; empty where there is none.
    pub(super) fn field(&self, number: usize) -> &'t str {
        self.fields.get(number - 1).copied().unwrap_or_default()
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

/// The cards between BEGIN BULK and ENDDATA, which may both be missing.
pub(super) fn cards<'t>(texts: &'t Texts<'_>) -> Result<Bulk<'t>, ImportError> {
    let lines = texts.lines()?;
    let begin = lines.iter().position(|line| begins_bulk(line.text)).map_or(0, |at| at + 1);
    let mut bulk = Bulk { cards: Vec::new(), lines_after: 0 };
    // Parameters may stand before the cards, too.
    for data in &lines[..begin] {
        let is_parameter = data.text.trim_start().get(..5).is_some_and(|word| word.eq_ignore_ascii_case("PARAM"));
        if is_parameter && let Ok(line) = fields(texts, Data { place: data.place, text: data.text.trim_start() }) {
            bulk.cards.push(Card { place: data.place, name: "PARAM".to_owned(), fields: line.data });
        }
    }
    let mut label = "";
    let (mut is_over, mut is_in_quotes) = (false, false);
    let (mut is_open, mut is_in_equation) = (false, false);
    for data in &lines[begin..] {
        let text = data.text.split('$').next().unwrap_or_default().trim_end();
        if text.trim().is_empty() {
            continue;
        }
        let quotes = text.matches(['\'', '"']).count();
        if is_in_quotes {
            is_in_quotes = quotes == 0;
            continue;
        }
        // What it includes stands in its place.
        if is_include(text) {
            is_in_quotes = quotes == 1;
            continue;
        }
        if is_over {
            bulk.lines_after += 1;
            continue;
        }
        if text.trim_start().get(..7).is_some_and(|word| word.eq_ignore_ascii_case("ENDDATA")) {
            is_over = true;
            continue;
        }
        if begins_bulk(text) {
            let help = "write the deck without superelements";
            return Err(texts.refuse(data.place, "a second part of bulk data", help));
        }
        // The commas of an equation are none between fields.
        let starts_equation = text.trim_start().get(..6).is_some_and(|word| word.eq_ignore_ascii_case("DEQATN"));
        if starts_equation {
            bulk.cards.push(Card { place: data.place, name: "DEQATN".to_owned(), fields: Vec::new() });
        }
        is_in_equation = starts_equation || (is_in_equation && text.starts_with([' ', '+', '*', ',']));
        if is_in_equation {
            continue;
        }
        // A line that ends in a comma goes on in the next, which may begin with a number at once.
        let goes_on = is_open && text.trim_start().starts_with(|first: char| first.is_ascii_digit());
        is_open = text.ends_with(',');
        let line = if goes_on {
            let mut data: Vec<&str> = text.split(',').map(str::trim).take(8).collect();
            data.resize(8, "");
            Line { head: "", data, label: "" }
        } else {
            fields(texts, Data { place: data.place, text })?
        };
        if line.head.is_empty() || line.head.starts_with(['+', '*']) {
            let [of_line, of_card] = [line.head, label].map(|label| label.trim_start_matches(['+', '*']));
            let is_apart = !of_line.is_empty() && !of_card.is_empty() && !of_line.eq_ignore_ascii_case(of_card);
            match bulk.cards.last_mut() {
                Some(card) if !is_apart => card.fields.extend(line.data),
                _ => {
                    let found = "a line that continues no card before it";
                    return Err(texts.refuse(data.place, found, "write each continuation under its card"));
                }
            }
        } else {
            let name = line.head.trim_end_matches('*').trim_end().to_uppercase();
            let is_name = name.starts_with(|letter: char| letter.is_ascii_uppercase())
                && name.bytes().all(|byte| byte.is_ascii_alphanumeric());
            if !is_name || name.len() > 8 {
                let found = format!("found {}, expected a card", texts.shown(*data));
                let help = "check this line; what stands before the cards ends with BEGIN BULK, and replication (=) is not read";
                return Err(texts.refuse(data.place, found, help));
            }
            bulk.cards.push(Card { place: data.place, name, fields: line.data });
        }
        label = line.label;
    }
    Ok(bulk)
}

fn begins_bulk(text: &str) -> bool {
    let mut words = text.split([' ', '=', ',']).filter(|word| !word.is_empty());
    let is = |word: Option<&str>, names: &[&str]| {
        word.is_some_and(|word| names.iter().any(|name| word.eq_ignore_ascii_case(name)))
    };
    is(words.next(), &["BEGIN"]) && is(words.next(), &["BULK", "SUPER", "AUXMODEL"])
}

/// True if a line names a file to be taken in.
pub(crate) fn is_include(text: &str) -> bool {
    let text = text.trim_start();
    text.get(..7).is_some_and(|word| word.eq_ignore_ascii_case("INCLUDE"))
        && text[7..].starts_with([' ', '\t', '\'', '"', '='])
}

fn fields<'t>(texts: &Texts<'_>, line: Data<'t>) -> Result<Line<'t>, ImportError> {
    let Data { place, text } = line;
    if !text.is_ascii() {
        let found = format!("{} with letters that no card has", texts.shown(line));
        return Err(texts.refuse(place, found, "check the file"));
    }
    if text.contains(',') {
        let mut parts = text.split(',').map(str::trim);
        let head = parts.next().unwrap_or_default();
        let count = if head.contains('*') { 4 } else { 8 };
        let mut data: Vec<&str> = parts.by_ref().take(count).collect();
        data.resize(count, "");
        let label = parts.next().unwrap_or_default();
        if parts.any(|part| !part.is_empty()) {
            let found = format!("{} has more than {} fields", texts.shown(line), count + 2);
            return Err(texts.refuse(place, found, "go on in the next line, which begins with a comma"));
        }
        return Ok(Line { head, data, label });
    }
    let part = |from: usize, to: usize| text.get(from..to.min(text.len())).unwrap_or_default().trim();
    let head = part(0, 8);
    let width = if head.contains('*') { 16 } else { 8 };
    let data = (8..72).step_by(width).map(|from| part(from, from + width)).collect();
    Ok(Line { head, data, label: part(72, 80) })
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
