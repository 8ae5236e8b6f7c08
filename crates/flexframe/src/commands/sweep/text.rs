//! The table of a sweep as text: all of it as CSV, and a part for people.

use std::io::{self, Write};
use std::path::Path;

use report::{Form, quantity, quoted};
use toml::Value;
use whole_file::WholeFile;

use super::plan::{Asked, Plan};
use super::table::{RowState, Table};
use crate::rows::columns::column_of;

/// More rows than this are thinned: the file has them all.
const ROWS: usize = 20;
/// More parameters and numbers than this do not fit a line.
const COLUMNS: usize = 8;

/// Writes all rows: the number of the row from 0, what has become of it, its parameters and results, and why it failed.
pub(super) fn write_csv(path: &Path, plan: &Plan, table: &Table) -> io::Result<()> {
    let mut file = WholeFile::create(path)?;
    let widths = widths_of(plan, table);
    let mut heads = vec!["row".to_owned(), "status".to_owned()];
    heads.extend(heads_of(plan, &widths));
    heads.push("failure".to_owned());
    let quoted: Vec<String> = heads.iter().map(|head| quoted(head)).collect();
    writeln!(file, "{}", quoted.join(","))?;
    for (i, row) in table.rows.iter().enumerate() {
        let (status, failure) = match row {
            RowState::Open => ("open", ""),
            RowState::Done(_) => ("done", ""),
            RowState::Failed(words) => ("failed", words.as_str()),
        };
        write!(file, "{i},{status}")?;
        for (_, values) in &plan.parameters {
            let text = match &values[i] {
                Value::String(text) => text.clone(),
                other => other.to_string(),
            };
            write!(file, ",{}", quoted_line(&text))?;
        }
        for number in numbers(row, &widths) {
            match number.filter(|number| !number.is_nan()) {
                // The shortest text that is read back as the same number.
                Some(number) => write!(file, ",{number:?}")?,
                None => write!(file, ",")?,
            }
        }
        writeln!(file, ",{}", quoted_line(failure))?;
    }
    file.finish()
}

/// Rows that were run, for people.
pub(super) fn shown(plan: &Plan, table: &Table) -> report::Table {
    let widths = widths_of(plan, table);
    let run: Vec<usize> = (0..table.rows.len()).filter(|row| table.rows[*row] != RowState::Open).collect();
    let field = |number: Option<f64>, row: &RowState| match (number, row) {
        (_, RowState::Failed(_)) => "failed".into(),
        (Some(number), _) if !number.is_nan() => number.into(),
        _ => report::Value::NONE,
    };
    let parameter = |value: &Value| match value {
        Value::Float(number) => quantity(*number),
        other => other.to_string(),
    };
    let mut columns: Vec<Vec<report::Value>> = plan
        .parameters
        .iter()
        .map(|(_, values)| run.iter().map(|row| parameter(&values[*row]).into()).collect())
        .collect();
    let results: Vec<Vec<_>> = run.iter().map(|row| numbers(&table.rows[*row], &widths).collect()).collect();
    let count = results.first().map_or(0, Vec::len);
    columns.extend(
        (0..count).map(|k| run.iter().zip(&results).map(|(row, of_row)| field(of_row[k], &table.rows[*row])).collect()),
    );
    let heads = heads_of(plan, &widths);
    let left =
        if heads.len() > COLUMNS { format!("the first {COLUMNS} of {} columns", heads.len()) } else { String::new() };
    let shown =
        report::Table::default().titled(left).most(ROWS).spread().text_only("row", Form::Plain, run.iter().copied());
    heads
        .into_iter()
        .zip(columns)
        .take(COLUMNS)
        .fold(shown, |shown, (head, column)| shown.text_only(head, Form::Plain, column))
}

/// How many numbers each result has; 0 where no row is done.
fn widths_of(plan: &Plan, table: &Table) -> Vec<usize> {
    (0..plan.results.len()).map(|result| table.width(result).unwrap_or_default()).collect()
}

/// The heads of parameters and results.
fn heads_of(plan: &Plan, widths: &[usize]) -> Vec<String> {
    let of_result = |((name, asked), width): ((&String, &Asked), &usize)| -> Vec<String> {
        match (asked, *width) {
            (Asked::Final(_) | Asked::Peak(_), 1) => vec![name.clone()],
            (asked, width) => {
                let column = asked.column().and_then(column_of);
                let names = column.map_or(&[][..], |column| column.components().names());
                let of_component =
                    |k: usize| names.get(k).map_or_else(|| (k + 1).to_string(), |name| (*name).to_owned());
                (0..width).map(|k| format!("{name} {}", of_component(k))).collect()
            }
        }
    };
    let parameters = plan.parameters.iter().map(|(key, _)| key.clone());
    parameters.chain(plan.results.iter().zip(widths).flat_map(of_result)).collect()
}

/// The numbers of all results of a row; none where there is none.
fn numbers<'a>(row: &'a RowState, widths: &'a [usize]) -> impl Iterator<Item = Option<f64>> + 'a {
    widths.iter().enumerate().flat_map(move |(i, width)| {
        let of_row = match row {
            RowState::Done(done) => done.results.get(i),
            RowState::Open | RowState::Failed(_) => None,
        };
        (0..*width).map(move |k| of_row.and_then(|numbers| numbers.get(k)).copied())
    })
}

/// A field of one line.
fn quoted_line(text: &str) -> String {
    quoted(&text.lines().collect::<Vec<_>>().join(" "))
}
