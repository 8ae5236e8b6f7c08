//! The cards of a deck: fields of 8 or 16 letters or between commas, the lines that continue them, and those that repeat them.

use std::collections::{HashMap, HashSet};

use crate::error::ImportError;
use crate::own::nastran::card::Card;
use crate::own::nastran::replication::{repeated, times};
use crate::own::texts::{Data, Place, Texts};

/// The bulk data.
pub(super) struct Bulk<'t> {
    pub(super) cards: Vec<Card<'t>>,
    /// Names that comments give to properties.
    pub(super) names: Vec<(u64, &'t str)>,
    /// Lines after ENDDATA.
    pub(super) lines_after: usize,
}

/// The fields of a line: its first, its data, and the label of the line that continues it.
struct Line<'t> {
    head: &'t str,
    data: Vec<&'t str>,
    label: &'t str,
}

/// A line that stands apart from the card that it continues.
struct Apart<'t> {
    place: Place,
    data: Vec<&'t str>,
    label: String,
}

impl<'t> Line<'t> {
    fn card(self, place: Place, name: String) -> Card<'t> {
        Card::new(place, name, self.data, label_of(self.label))
    }
}

/// The name by which a line and its card know each other.
fn label_of(text: &str) -> String {
    text.trim_start_matches(['+', '*']).to_uppercase()
}

/// The cards between BEGIN BULK and ENDDATA, which may both be missing.
pub(super) fn cards<'t>(texts: &'t Texts<'_>) -> Result<Bulk<'t>, ImportError> {
    let lines = texts.lines()?;
    let begin = lines.iter().position(|line| begins_bulk(line.text)).map_or(0, |at| at + 1);
    let mut bulk = Bulk { cards: Vec::new(), names: names(&lines), lines_after: 0 };
    // Parameters may stand before the cards, too.
    for data in &lines[..begin] {
        let is_parameter = data.text.trim_start().get(..5).is_some_and(|word| word.eq_ignore_ascii_case("PARAM"));
        if is_parameter && let Ok(line) = fields(texts, Data { place: data.place, text: data.text.trim_start() }) {
            bulk.cards.push(line.card(data.place, "PARAM".to_owned()));
        }
    }
    let (mut is_over, mut is_in_quotes) = (false, false);
    let (mut is_open, mut is_in_equation) = (false, false);
    let mut apart: HashMap<String, Apart<'t>> = HashMap::new();
    // The name of the line apart that the last line is.
    let mut within: Option<String> = None;
    let labels = labels(texts, &lines[begin..]);
    for data in &lines[begin..] {
        let text = without_comment(data.text);
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
        let starts_equation = is_equation(text);
        if starts_equation {
            let line = Line { head: "", data: Vec::new(), label: "" };
            bulk.cards.push(line.card(data.place, "DEQATN".to_owned()));
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
            let (name, label) = (label_of(line.head), label_of(line.label));
            if let Some(before) = within.as_ref().and_then(|before| apart.get_mut(before))
                && (name.is_empty() || name == before.label)
            {
                before.data.extend(line.data);
                before.label = label;
                continue;
            }
            match bulk.cards.last_mut() {
                // A name that another card has is of that card.
                Some(card)
                    if within.is_none()
                        && (name.is_empty()
                            || name == card.label
                            || (card.label.is_empty() && !labels.contains(&name))) =>
                {
                    card.goes_on(line.data, label);
                }
                _ if labels.contains(&name) => {
                    within = Some(name.clone());
                    if apart.insert(name, Apart { place: data.place, data: line.data, label }).is_some() {
                        let found = "a second line of this name that continues a card";
                        return Err(texts.refuse(data.place, found, "give each card's continuation a name of its own"));
                    }
                }
                _ => return Err(alone(texts, data.place)),
            }
            continue;
        }
        within = None;
        if line.head.starts_with('=') {
            let before = bulk.cards.len().checked_sub(1).map(|last| &bulk.cards[last..]);
            let count = times(line.head).ok_or_else(|| expected_card(texts, *data))?;
            let made = match before {
                Some([card]) if !labels.contains(&card.label) => repeated(card, &line.data, count, data.place),
                _ => None,
            };
            let Some(made) = made else {
                let found = format!("found {}, which repeats no card before it", texts.shown(*data));
                let help = "write `=` for a field of the card before, `*(1)` to add to it, `==` for all the rest, `=3` to do so three \
                            times more; a card with continuations is not repeated: write it out";
                return Err(texts.refuse(data.place, found, help));
            };
            bulk.cards.extend(made);
        } else {
            let name = line.head.trim_end_matches('*').trim_end().to_uppercase();
            let is_name = name.starts_with(|letter: char| letter.is_ascii_uppercase())
                && name.bytes().all(|byte| byte.is_ascii_alphanumeric());
            if !is_name || name.len() > 8 {
                return Err(expected_card(texts, *data));
            }
            bulk.cards.push(line.card(data.place, name));
        }
    }
    // Lines that stand apart, card by card; those of one card follow from each other.
    for card in &mut bulk.cards {
        while !apart.is_empty()
            && let Some(line) = apart.remove(&card.label)
        {
            card.goes_on(line.data, line.label);
        }
    }
    match apart.into_values().map(|line| line.place).min() {
        Some(first) => Err(alone(texts, first)),
        None => Ok(bulk),
    }
}

fn alone(texts: &Texts<'_>, place: Place) -> ImportError {
    let found = "a line that continues no card";
    texts.refuse(place, found, "write it under its card, or give its name to field 10 of the line that it continues")
}

fn expected_card(texts: &Texts<'_>, data: Data<'_>) -> ImportError {
    let found = format!("found {}, expected a card", texts.shown(data));
    texts.refuse(data.place, found, "check this line; what stands before the cards ends with BEGIN BULK")
}

fn is_equation(text: &str) -> bool {
    text.trim_start().get(..6).is_some_and(|word| word.eq_ignore_ascii_case("DEQATN"))
}

/// The labels in the tenth fields of lines that the next line does not continue.
fn labels(texts: &Texts<'_>, lines: &[Data<'_>]) -> HashSet<String> {
    let texts_of_cards = lines.iter().map(|data| Data { text: without_comment(data.text), ..*data });
    let mut cards = texts_of_cards.filter(|data| !data.text.trim().is_empty()).peekable();
    let mut found = HashSet::new();
    while let Some(data) = cards.next() {
        // A short line has none.
        if data.text.len() <= 72 && !data.text.contains(',') {
            continue;
        }
        let label = fields(texts, data).map(|line| label_of(line.label)).unwrap_or_default();
        let is_next = cards.peek().is_some_and(|next| {
            let head = head_of(next.text);
            (head.is_empty() || head.starts_with(['+', '*'])) && ["", &label].contains(&&*label_of(head))
        });
        if !label.is_empty() && !is_next {
            found.insert(label);
        }
    }
    found
}

fn without_comment(text: &str) -> &str {
    text.split('$').next().unwrap_or_default().trim_end()
}

/// The first field of a line.
fn head_of(text: &str) -> &str {
    let end = text.find(',').unwrap_or(8.min(text.len()));
    text.get(..end).unwrap_or_default().trim()
}

/// Names of properties in comments of Femap (`$ Femap Property 3 : hub`) and HyperMesh (`$HMNAME PROP 3"hub"`).
fn names<'t>(lines: &[Data<'t>]) -> Vec<(u64, &'t str)> {
    let name = |data: &Data<'t>| -> Option<(u64, &'t str)> {
        let text = data.text.strip_prefix('$')?.trim();
        let (number, name) = match text.strip_prefix("Femap Property") {
            Some(rest) => rest.split_once(':')?,
            None => {
                let rest = text.strip_prefix("HMNAME")?.trim_start().strip_prefix("PROP")?;
                let (number, rest) = rest.split_once('"')?;
                (number, rest.split_once('"')?.0)
            }
        };
        let name = name.trim();
        (!name.is_empty()).then_some((number.trim().parse().ok()?, name))
    };
    lines.iter().filter_map(name).collect()
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
