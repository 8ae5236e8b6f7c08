//! Two runs on one page: the second as a ghost, and its courses beside those of the first with their differences.

use std::ops::Range;

use report::{Compared, Component, Fact, PageBalance, PageHistory, PageMotion, RunPage};

use crate::report::quantity;

/// A page of a run with another one, which is named `name`. Both are shown where they have the time in common; `None` where that is
/// less than two rows of the first.
pub(super) fn compared(mut first: RunPage, other: RunPage, name: &str) -> Option<RunPage> {
    let (start, end) = (*other.times.first()?, *other.times.last()?);
    let slack = 1e-9 * end.abs();
    let inside = |time: &f64| (start - slack..=end + slack).contains(time);
    let begin = first.times.iter().position(&inside)?;
    let rows = begin..first.times.iter().rposition(inside)? + 1;
    if rows.len() < 2 {
        return None;
    }
    if rows.len() < first.times.len() {
        let [from, to] = [first.times[rows.start], first.times[rows.end - 1]].map(quantity);
        let time = &first.units.time;
        first.warnings.push(format!(
            "{name} goes from {} to {} {time}: the runs are compared from {from} to {to} {time}.",
            quantity(start),
            quantity(end)
        ));
    }
    clip(&mut first, rows);
    let is_same = |(a, b): (&f64, &f64)| (a - b).abs() <= slack;
    if first.times.len() > other.times.len() || !first.times.iter().zip(&other.times).all(is_same) {
        first.warnings.push(format!(
            "{name} has its rows at other times: its courses are straight between them, which the differences show."
        ));
    }
    let mut alone = 0;
    first.histories = std::mem::take(&mut first.histories)
        .into_iter()
        .flat_map(|history| {
            let both = beside(&history, &first.times, &other, name);
            alone += usize::from(both.is_none());
            both.map_or_else(|| vec![history], Vec::from)
        })
        .collect();
    if alone > 0 {
        first
            .warnings
            .push(format!("{alone} courses are not compared: {name} does not have them, or in another unit."));
    }
    first.facts.push(Fact::new("Compared with", format!("{name}: {}", other.title)));
    first.compared = Some(Compared { name: name.to_owned(), times: other.times, bodies: other.bodies });
    Some(first)
}

/// The course of both runs, and their difference; `None` where the other has no such course.
fn beside(history: &PageHistory, times: &[f64], other: &RunPage, name: &str) -> Option<[PageHistory; 2]> {
    let is_same = |of: &&PageHistory| of.group == history.group && of.name == history.name && of.unit == history.unit;
    let found = other.histories.iter().find(is_same)?;
    let [mut theirs, mut differences] = [Vec::new(), Vec::new()];
    for component in &history.components {
        let of_other = found.components.iter().find(|of| of.name == component.name)?;
        let values = at(times, &other.times, &of_other.values);
        let difference = component.values.iter().zip(&values).map(|(own, other)| own - other).collect();
        let named = if component.name.is_empty() { name.to_owned() } else { format!("{} ({name})", component.name) };
        theirs.push(Component { name: named, values });
        differences.push(Component { name: component.name.clone(), values: difference });
    }
    let mut both = history.clone();
    if let [only] = &mut both.components[..] {
        only.name = if only.name.is_empty() { "this run".to_owned() } else { only.name.clone() };
    }
    both.components.extend(theirs);
    let difference =
        PageHistory { name: format!("{}: difference", history.name), components: differences, ..history.clone() };
    Some([both, difference])
}

/// Values at other times, on straight lines between the rows.
fn at(times: &[f64], rows: &[f64], values: &[f64]) -> Vec<f64> {
    let value = |time: &f64| {
        let after = rows.partition_point(|row| row <= time).clamp(1, rows.len().max(2) - 1);
        let (Some(a), Some(b)) = (rows.get(after - 1), rows.get(after)) else { return values[0] };
        let part = ((time - a) / (b - a)).clamp(0.0, 1.0);
        values[after - 1] * (1.0 - part) + values[after] * part
    };
    times.iter().map(value).collect()
}

/// Leaves only some rows of a run.
fn clip(report: &mut RunPage, rows: Range<usize>) {
    report.times = report.times[rows.clone()].to_vec();
    for body in &mut report.bodies {
        let shapes = body.shapes.len();
        let PageMotion { origins, attitudes, coordinates } = &mut body.motion;
        *origins = origins[rows.clone()].to_vec();
        *attitudes = attitudes[rows.clone()].to_vec();
        *coordinates = coordinates[rows.start * shapes..rows.end * shapes].to_vec();
    }
    let of_histories = report.histories.iter_mut().map(|history| &mut history.components);
    let of_balances = report.balances.iter_mut().flat_map(|PageBalance { terms, errors, .. }| [terms, errors]);
    for component in of_histories.chain(of_balances).flatten() {
        component.values = component.values[rows.clone()].to_vec();
    }
}

#[cfg(test)]
mod tests {
    use super::at;

    /// Closed form: straight lines.
    #[test]
    fn values_between_rows_lie_on_straight_lines() {
        let (rows, values) = ([0.0, 1.0, 3.0], [2.0, 4.0, -2.0]);
        assert_eq!(at(&[0.0, 0.5, 1.0, 2.0, 3.0], &rows, &values), [2.0, 3.0, 4.0, 1.0, -2.0]);
        assert_eq!(at(&rows, &rows, &values), values);
        assert_eq!(at(&[0.0], &[0.0], &[7.0]), [7.0]);
    }
}
