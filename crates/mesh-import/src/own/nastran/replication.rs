//! Replication: cards that repeat the one before them, field by field.

use std::borrow::Cow;

use crate::own::nastran::card::{Card, Change, number};
use crate::own::texts::Place;

/// Cards that one line makes at most.
const MOST: usize = 1_000_000;
/// Fields of a card without continuations.
const FIELDS: usize = 8;

/// How often the head of a line, `=`, `=4` or `=(4)`, repeats the card before it; 0 where its own fields say how.
pub(super) fn times(head: &str) -> Option<usize> {
    match head.strip_prefix('=')?.trim_start_matches('(').trim_end_matches(')') {
        "" => Some(0),
        count => count.parse().ok().filter(|count| (1..=MOST).contains(count)),
    }
}

/// The cards that a line makes: one by its own fields, or `count` with the increments of the card before. None where that is not possible.
pub(super) fn repeated<'t>(before: &Card<'t>, data: &[&'t str], count: usize, place: Place) -> Option<Vec<Card<'t>>> {
    if before.len() > FIELDS {
        return None;
    }
    if count > 0 {
        if before.changes.is_empty() || data.iter().any(|field| !matches!(*field, "" | "==" | "=")) {
            return None;
        }
        let mut made: Vec<Card<'t>> = Vec::with_capacity(count);
        for _ in 0..count {
            let next = image(made.last().unwrap_or(before), place)?;
            made.push(next);
        }
        return Some(made);
    }
    let mut card = before.again(place);
    card.changes.clear();
    card.fields.resize(FIELDS, Cow::Borrowed(""));
    for (at, field) in data.iter().enumerate() {
        match *field {
            "==" => break,
            "=" => {}
            text => match text.strip_prefix('*') {
                Some(added) => {
                    let added = added.trim_start_matches('(').trim_end_matches(')');
                    let change = added.parse().map(Change::Whole).ok().or_else(|| number(added).map(Change::Number))?;
                    card.fields[at] = Cow::Owned(sum(before.field(at + 1), &change)?);
                    card.changes.push((at, change));
                }
                None => card.fields[at] = Cow::Borrowed(text),
            },
        }
    }
    Some(vec![card])
}

/// The next card with the same increments.
fn image<'t>(before: &Card<'t>, place: Place) -> Option<Card<'t>> {
    let mut card = before.again(place);
    for (at, change) in &before.changes {
        card.fields[*at] = Cow::Owned(sum(before.field(at + 1), change)?);
    }
    Some(card)
}

/// A field after its increment; an empty one is nought. None where it is of another kind.
fn sum(field: &str, change: &Change) -> Option<String> {
    match change {
        Change::Whole(added) if field.bytes().all(|byte| byte.is_ascii_digit()) => {
            let sum = if field.is_empty() { 0 } else { field.parse::<i64>().ok()? }.checked_add(*added)?;
            Some(sum.to_string())
        }
        Change::Whole(added) => plus(field, *added as f64),
        Change::Number(added) => plus(field, *added),
    }
}

fn plus(field: &str, added: f64) -> Option<String> {
    let sum = if field.is_empty() { 0.0 } else { number(field)? } + added;
    sum.is_finite().then(|| format!("{sum:?}"))
}
